//! What the bodies of an arm look like as solids: where their mass is, how far it spreads, and about which sizes of inertia a reader can judge.

use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::exact::Polynomial;
use armgen_codegen::manipulator::{Manipulator, PlacedBody};
use nalgebra::{Matrix3, Vector3};

use crate::table::{Align, Table};

/// A body with mass, in the frame of what carries it.
pub(super) struct Solid {
    pub(super) mass: f64,
    pub(super) com: Vector3<f64>,
    /// About the centre of mass.
    inertia: Matrix3<f64>,
}

impl Solid {
    /// Bodies in one frame as one (Steiner); `None` without mass.
    pub(super) fn of(manipulator: &Manipulator, parts: &[PlacedBody]) -> Option<Solid> {
        let number = |p: &Polynomial| nominal(manipulator, p).to_f64();
        let solids: Vec<Solid> = parts
            .iter()
            .map(|PlacedBody { body, .. }| {
                let [xx, xy, yy, xz, yz, zz] = body.inertia.each_ref().map(number);
                let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
                Solid { mass: number(&body.mass), com: Vector3::from(body.com.each_ref().map(number)), inertia }
            })
            .collect();
        let mass: f64 = solids.iter().map(|solid| solid.mass).sum();
        if mass <= 0.0 {
            return None;
        }
        let com = solids.iter().map(|solid| solid.com * solid.mass).sum::<Vector3<f64>>() / mass;
        let inertia = solids.iter().map(|solid| {
            let d = solid.com - com;
            solid.inertia + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * solid.mass
        });
        Some(Solid { mass, com, inertia: inertia.sum() })
    }
}

/// One row per link, and one of the load: mass, centre of mass, principal moments, radius of gyration about the axis of the
/// largest, the box that has them, and its density: metal has up to 8000 kg/m³, and links, which are hollow, about that of water.
pub(super) fn table(manipulator: &Manipulator) -> String {
    use Align::{Left, Right};
    let mut table = Table::new([
        ("link", Left),
        ("mass (kg)", Right),
        ("com x (m)", Right),
        ("y", Right),
        ("z", Right),
        ("principal moments (kg m²)", Left),
        ("radius of gyration (m)", Right),
        ("as a box (m)", Left),
        ("of density (kg/m³)", Right),
    ]);
    let links =
        manipulator.joints.iter().enumerate().map(|(i, joint)| (format!("{} {}", i + 1, joint.name), joint.link.as_slice()));
    for (name, parts) in links.chain(manipulator.payload.iter().map(|load| ("payload".into(), std::slice::from_ref(load)))) {
        let Some(Solid { mass, com, inertia }) = Solid::of(manipulator, parts) else {
            let none = String::new;
            table.row([name, "0".into(), none(), none(), none(), none(), none(), none(), none()]);
            continue;
        };
        let mut moments: Vec<f64> = inertia.symmetric_eigenvalues().iter().copied().collect();
        moments.sort_by(f64::total_cmp);
        let rounding = (moments[2].abs() + mass * com.norm_squared()) * 1e-12;
        let moments = moments.iter().map(|moment| if moment.abs() <= rounding { 0.0 } else { *moment }).collect::<Vec<_>>();
        table.row([
            name,
            short(mass),
            short(com.x),
            short(com.y),
            short(com.z),
            moments.iter().map(|moment| short(*moment)).collect::<Vec<_>>().join(", "),
            short((moments[2].max(0.0) / mass).sqrt()),
            as_box(mass, &moments),
            density(mass, &moments).map(short).unwrap_or_default(),
        ]);
    }
    table.text()
}

/// The sides of the homogeneous cuboid with these moments about its centre, the longest first: I_x = m (y² + z²) / 12. None has those of a body
/// that breaks the triangle inequality.
fn as_box(mass: f64, moments: &[f64]) -> String {
    let sum: f64 = moments.iter().sum();
    if sum == 0.0 {
        return "a point".into();
    }
    let rounding = sum * 1e-9;
    let squares = squared_sides(mass, moments);
    if squares.iter().any(|square| square * mass < -6.0 * rounding) {
        return "no box has these".into();
    }
    let two = |side: f64| if side * side * mass <= 6.0 * rounding { "0".into() } else { format!("{}", rounded(side)) };
    squares.iter().map(|square| two(square.max(0.0).sqrt())).collect::<Vec<_>>().join(" x ")
}

fn squared_sides(mass: f64, moments: &[f64]) -> Vec<f64> {
    let sum: f64 = moments.iter().sum();
    moments.iter().map(|moment| 6.0 * (sum - 2.0 * moment) / mass).collect()
}

/// The density of that box, if it has a volume.
fn density(mass: f64, moments: &[f64]) -> Option<f64> {
    let squares = squared_sides(mass, moments);
    let largest = squares.iter().copied().fold(0.0, f64::max);
    let is_thick = squares.iter().all(|square| *square > largest * 1e-9);
    is_thick.then(|| rounded(mass / squares.iter().product::<f64>().sqrt()))
}

/// Two digits.
fn rounded(value: f64) -> f64 {
    let scale = 10f64.powi(1 - value.log10().floor() as i32);
    (value * scale).round() / scale
}

/// Where gravity points, in words.
pub(super) fn up(gravity: [f64; 3]) -> String {
    let size = Vector3::from(gravity).norm();
    if size == 0.0 {
        return "none: the arm moves in a horizontal plane, or in free fall".into();
    }
    let up = Vector3::from(gravity) / -size;
    let axis = up.iamax();
    let sign = if up[axis] < 0.0 { "-" } else { "" };
    let along = format!("{sign}{}0", ["x", "y", "z"][axis]);
    let off = up.cross(&Vector3::ith(axis, 1.0)).norm().asin().to_degrees();
    if off < 1e-6 {
        format!("{along} points up")
    } else {
        format!("up is {} off {along}", degrees(off))
    }
}

fn degrees(angle: f64) -> String {
    format!("{} degrees", short(angle))
}

/// Four digits.
pub(super) fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = 3 - value.abs().log10().floor() as i32;
    if !(-3..=8).contains(&digits) {
        return format!("{value:.3e}");
    }
    let text = format!("{value:.*}", digits.max(0) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_is_said_in_words() {
        assert_eq!(up([0.0, 0.0, -9.81]), "z0 points up");
        assert_eq!(up([0.0, 9.81, 0.0]), "-y0 points up");
        assert_eq!(up([0.0; 3]), "none: the arm moves in a horizontal plane, or in free fall");
        assert_eq!(up([0.0, -9.81 * 0.5, -9.81 * 0.75f64.sqrt()]), "up is 30 degrees off z0");
    }

    #[test]
    fn numbers_have_four_digits() {
        assert_eq!([0.25, -0.021_234_5, 12_345.0, 1e-9].map(short), ["0.25", "-0.02123", "12345", "1.000e-9"]);
    }

    /// 1 kg, 0.3 m by 0.2 m by 0.1 m; a rod; moments of no body.
    #[test]
    fn moments_are_those_of_a_box() {
        assert_eq!(as_box(1.0, &[0.05 / 12.0, 0.1 / 12.0, 0.13 / 12.0]), "0.3 x 0.2 x 0.1");
        assert_eq!(as_box(12.0, &[0.0, 4.0, 4.0]), "2 x 0 x 0");
        assert_eq!(as_box(1.0, &[0.1, 0.1, 0.5]), "no box has these");
        assert_eq!(as_box(3.0, &[0.0; 3]), "a point");
        assert_eq!(density(6.0, &[0.3 / 12.0, 0.6 / 12.0, 0.78 / 12.0]), Some(1000.0));
        assert_eq!(density(12.0, &[0.0, 4.0, 4.0]), None);
        assert_eq!(density(3.0, &[0.0; 3]), None);
    }

    /// Two halves of a rod are the rod: 1/12 m l² about its middle.
    #[test]
    fn parts_are_one_solid() {
        let text = "name: a\nconvention: standard\ngravity: [0, 0, -9.81]\njoints:\n  - {name: j, type: revolute, a: 0, alpha: 0, d: 0, theta: 0, link: \
                    {mass: 1, com: [0.5, 0, 0], inertia: {yy: 1/12, zz: 1/12}, attached: [{origin: {xyz: [1, 0, 0]}, mass: 1, com: [0.5, 0, 0], \
                    inertia: {yy: 1/12, zz: 1/12}}]}}\n";
        let source = armgen_codegen::source::Source::new("a.yaml", text);
        let manipulator = armgen_codegen::validate::read(&source).0.expect("it is valid").0;
        let solid = Solid::of(&manipulator, &manipulator.joints[0].link).expect("it has mass");
        assert_eq!((solid.mass, solid.com.x), (2.0, 1.0));
        assert!((solid.inertia[(2, 2)] - 2.0 * 4.0 / 12.0).abs() < 1e-12);
    }
}
