//! Inertias of all links that are too large or too small by a factor which none of them alone betrays.
//!
//! A body has mass m and the tensor I about its centre of mass, with principal moments I_k. The cuboid of even density with the same
//! tensor has sides with the squares s_k = 6 (tr I - 2 I_k) / m. Their product is the determinant of 6 (tr I 1 - 2 I) / m, and the
//! density is m over its root. With all tensors ten times as large it is 32 times as small.

use super::{number, short, Arm, LEAD};
use crate::description::BodyDescription;
use crate::diagnostic::Code;
use crate::source::Span;
use crate::validate::Context;

/// kg/m³: rigid foam. Links are hollow, and their boxes as light as water at the median.
const FOAM: f64 = 100.0;
const WATER: f64 = 1000.0;
/// kg/m³: the lightest foam of packaging, and the densest metal.
const LIGHTEST_FOAM: f64 = 20.0;
const OSMIUM: f64 = 22_600.0;
/// The fewest bodies with a meaningful median.
const FEWEST: usize = 3;
/// Beside the cube of the sum of the squared sides their product is 0: a plate, a rod.
const FLAT: f64 = 1e-7;

impl Arm<'_> {
    /// Whether half of the links are lighter than foam, or denser than lead.
    pub(super) fn check_densities(&self, context: &mut Context<'_>) {
        let bodies = self.joints.iter().zip(&self.masses).filter_map(|(joint, mass)| Some((joint.link.as_ref()?, *mass)));
        let mut densities: Vec<(f64, Span)> = bodies.filter_map(|(link, mass)| density(link, mass, context)).collect();
        if densities.len() < FEWEST {
            return;
        }
        let place = densities[0].1;
        densities.sort_by(|a, b| a.0.total_cmp(&b.0));
        let median = densities[densities.len() / 2].0;
        if median < FOAM && self.has_mostly_placeholders(context) {
            let message = "half of the links have an inertia as templates have it, and are lighter than foam with it";
            let help = "write what the data sheet says, or leave `inertia` out where it is not known";
            context.report(Code::PlaceholderInertia, place, message, "this one and others", help);
            return;
        }
        // Inertia grows as the density to the power -2/3.
        let factor = |ratio: f64| short(ratio.powf(2.0 / 3.0).round());
        let (code, words, slip) = match median {
            _ if median < FOAM => {
                (Code::ImplausibleInertia, "lighter than foam", format!("large by a factor of {}", factor(WATER / median)))
            }
            _ if median > LEAD => {
                (Code::ImplausibleDensity, "denser than lead", format!("small by a factor of {}", factor(median / WATER)))
            }
            _ => return,
        };
        let message = format!(
            "half of the links are {words}: as cuboids with these masses and inertias they have {} kg/m³ at the median, where those of arms have 200 to 6000",
            short(median.round())
        );
        let help = format!("inertias are in kg m², about the centre of mass; about the density of water is usual, so all may be too {slip} or so");
        context.report(code, place, message, "this one and others", help);
    }

    /// Whether more than half of the links have a tensor of a template.
    fn has_mostly_placeholders(&self, context: &mut Context<'_>) -> bool {
        let links = self.joints.iter().filter_map(|joint| joint.link.as_ref());
        let all = links.clone().count();
        2 * links.filter(|link| self.has_placeholder(link, context)).count() > all
    }
}

/// The density, kg/m³, of the cuboid with the inertia of a link, if that has a volume, and the place of the inertia.
fn density(link: &BodyDescription, mass: f64, context: &mut Context<'_>) -> Option<(f64, Span)> {
    let inertia = link.inertia.as_ref().filter(|_| link.attached.is_empty())?;
    let tensor = inertia.elements.each_ref().map(|value| number(value, context));
    Some((density_of_cuboid(mass, tensor)?, inertia.key))
}

/// The density, kg/m³, of the cuboid with a mass, kg, and a tensor xx xy yy xz yz zz about its centre, kg m²; `None` where it has no volume, or where
/// no body has that tensor.
pub fn density_of_cuboid(mass: f64, tensor: [f64; 6]) -> Option<f64> {
    let [xx, xy, yy, xz, yz, zz] = tensor;
    let trace = xx + yy + zz;
    let [a, b, c] = [xx, yy, zz].map(|moment| 6.0 * (trace - 2.0 * moment) / mass);
    let [d, e, f] = [xy, xz, yz].map(|product| -12.0 * product / mass);
    let minor = a * b - d * d;
    let volume = c * minor - a * f * f - b * e * e + 2.0 * d * e * f;
    let is_a_solid = mass > 0.0 && a > 0.0 && minor > 0.0 && volume > FLAT * (a + b + c).powi(3);
    is_a_solid.then(|| mass / volume.sqrt())
}

/// The doubt about the density of the cuboid of one body, kg/m³: no material is as light or as dense. Tables show it with the body, and
/// it is not a warning, because files in wide use have such a link or two, and work.
pub fn doubt_of_density(density: f64) -> Option<&'static str> {
    match density {
        _ if density < LIGHTEST_FOAM => Some("lighter than foam"),
        _ if density > OSMIUM => Some("denser than osmium"),
        _ => None,
    }
}
