//! Numbers that seem to refer to another frame than the required one.
//!
//! | kind | warns of | since |
//! |---|---|---|
//! | `coincident-axes` | two revolute joints, one after the other, that turn about one line | no arm spends two motors on one motion; angles of the standard convention in rows of the modified one, or the other way round, leave such a pair |
//! | `inertia-about-frame` | a tensor with the products of inertia -m c_i c_j of its own centre of mass c, and moments to match | that is the tensor about the frame's origin of a body whose own axes are those of the frame (Steiner; Siciliano et al., Eq. B.67); armgen adds Steiner's terms itself |

use super::slips::passes;
use super::{number, Arm, Body};
use crate::description::{Convention, JointDescription, Value, INERTIA_ELEMENTS};
use crate::diagnostic::Code;
use crate::document::{decimal_text, Expression, ExpressionKind};
use crate::exact::Number;
use crate::kinds::JointKind;
use crate::validate::{call, Context};

/// How nearly axes are one line: the sine of the angle between them, and m.
const ONE_LINE: f64 = 1e-9;
/// The tolerance of the comparison with Steiner's theorem, relative to the largest product: for several products, and for a single
/// product, which may agree by chance.
const NEARLY: f64 = 0.05;
const NEARLY_ALONE: f64 = 0.01;
/// Products smaller than this part of the largest moment say nothing.
const TELLING: f64 = 0.15;

impl Arm<'_> {
    /// Two joints about one line.
    pub(super) fn check_axes(&self, convention: Option<Convention>, context: &mut Context<'_>) {
        let standard = match convention {
            Some(Convention::Standard) => true,
            Some(Convention::Modified) => false,
            _ => return,
        };
        let revolute = |joint: &JointDescription| joint.kind.as_ref().is_some_and(|kind| kind.value == JointKind::Revolute);
        for (i, second) in self.joints.iter().enumerate() {
            let Some(before) = self.parents[i].filter(|_| second.mount.is_none()) else { continue };
            let first = &self.joints[before];
            // The row that holds a and alpha from the axis of the first to that of the second.
            let row = if standard { first } else { second };
            let (Some(alpha), true) = (&row.alpha, revolute(first) && revolute(second)) else { continue };
            let sine = number(&row.alpha, context).sin();
            if number(&row.a, context).abs() > ONE_LINE || sine.abs() > ONE_LINE {
                continue;
            }
            let message = format!("the joints {} and {} turn about one line", call(before, first), call(i, second));
            let help = match standard {
                false => "a row of the modified convention holds a and alpha of the link before it, those that the books call a_{i-1}, alpha_{i-1}: is this table one of the standard convention?",
                true => "a row of the standard convention holds a and alpha of its own link, up to the next axis: is this table one of the modified convention?",
            };
            context.report(Code::CoincidentAxes, alpha.span, message, "parallel to the axis before it, and a is 0", help);
        }
    }
}

/// A tensor about the origin of the frame instead of the centre of mass.
pub(super) fn check_reference(body: &Body<'_>, context: &mut Context<'_>) {
    let (Some(com), Some(inertia)) = (&body.description.com, &body.description.inertia) else { return };
    if inertia.rotation.is_some() {
        return;
    }
    let Body { mass, whose, .. } = body;
    let c = com.value.each_ref().map(|value| number(value, context));
    let given = inertia.elements.each_ref().map(|value| number(value, context));
    let size = c.iter().map(|x| x * x).sum::<f64>();
    let steiner = [
        mass * (size - c[0] * c[0]),
        -mass * c[0] * c[1],
        mass * (size - c[1] * c[1]),
        -mass * c[0] * c[2],
        -mass * c[1] * c[2],
        mass * (size - c[2] * c[2]),
    ];
    let (moments, products) = ([0, 2, 5], [1, 3, 4]);
    let largest_product = products.map(|k| steiner[k].abs()).into_iter().fold(0.0, f64::max);
    let largest_moment = moments.map(|k| given[k]).into_iter().fold(0.0, f64::max);
    let alone = products.iter().filter(|&&k| steiner[k].abs() > NEARLY * largest_product).count() == 1;
    let nearly = if alone { NEARLY_ALONE } else { NEARLY };
    let matches = products.iter().all(|&k| (given[k] - steiner[k]).abs() <= nearly * largest_product);
    let own = moments.map(|k| given[k] - steiner[k]);
    let is_a_body = own.iter().all(|moment| *moment >= 0.0) && own.iter().all(|m| 2.0 * m <= own.iter().sum::<f64>());
    if largest_product < TELLING * largest_moment || !matches || !is_a_body {
        return;
    }
    let message = format!("the inertia of {whose} has the products -m c_i c_j of its own centre of mass: it seems to be about the origin of the frame");
    let help = match about_centre(body, context) {
        Some(tensor) => format!("give it about the centre of mass: {tensor}"),
        None => "give it about the centre of mass: less m (c'c 1 - c c')".to_owned(),
    };
    context.report(Code::InertiaAboutFrame, inertia.key, message, "about the frame's origin?", help);
}

/// The tensor less Steiner's terms, exactly, where it is one of a body and its digits end: I - m (c'c 1 - c c').
fn about_centre(body: &Body<'_>, context: &mut Context<'_>) -> Option<String> {
    let number = |value: &Value, context: &mut Context<'_>| match value {
        Some(Expression { kind: ExpressionKind::InUnit(..), .. }) => None,
        Some(expression) => context.number(expression),
        None => Some(Number::zero()),
    };
    let (com, inertia) = (body.description.com.as_ref()?, body.description.inertia.as_ref()?);
    let m = number(&body.description.mass, context)?;
    let [x, y, z] = com.value.each_ref().map(|value| number(value, context));
    let c = [x?, y?, z?];
    let product = |i: usize, j: usize| &m * &(&c[i] * &c[j]);
    let moment = |i: usize, j: usize| &product(i, i) + &product(j, j);
    let steiner = [moment(1, 2), -&product(0, 1), moment(0, 2), -&product(0, 2), -&product(1, 2), moment(0, 1)];
    let mut own = Vec::new();
    for (value, steiner) in inertia.elements.iter().zip(&steiner) {
        own.push(&number(value, context)? - steiner);
    }
    let floats: [f64; 6] = own.iter().map(Number::to_f64).collect::<Vec<_>>().try_into().ok()?;
    if !passes(&floats, body.mass, f64::INFINITY) {
        return None;
    }
    let texts: Option<Vec<String>> = INERTIA_ELEMENTS
        .iter()
        .zip(&own)
        .filter(|(_, element)| !element.is_zero())
        .map(|(name, element)| Some(format!("{name}: {}", decimal_text(element.as_rational()?)?)))
        .collect();
    Some(format!("{{{}}}", texts?.join(", ")))
}
