//! The bodies of an arm as solids: the places of their masses, and their extent along each axis, in sizes that a reader can judge.

use std::collections::BTreeMap;

use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::exact::Polynomial;
use armgen_codegen::manipulator::{Manipulator, PlacedBody};
use armgen_codegen::validate::{density_of_cuboid, doubt_of_density};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use super::{digits, legend};
use armgen_terminal::number;
use armgen_terminal::table::{Align, Table};

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

    /// The principal moments, each at the axis of the frame nearest to its own axis, and the largest turn from an axis of the frame to its
    /// principal axis. The turn is a vector along its axis, as long as its angle in degrees. The axes of equal moments are arbitrary, so
    /// they are not turned.
    fn moments(&self) -> ([f64; 3], Vector3<f64>) {
        let principal = SymmetricEigen::new(self.inertia);
        let along = |k: usize, axis: usize| principal.eigenvectors[(axis, k)].abs();
        const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [2, 1, 0], [0, 2, 1]];
        let fit = |order: &[usize; 3]| (0..3).map(|axis| along(order[axis], axis)).sum::<f64>();
        let order = ORDERS.into_iter().reduce(|best, order| if fit(&order) > fit(&best) + 1e-9 { order } else { best });
        let order = order.unwrap_or([0, 1, 2]);
        let largest = principal.eigenvalues.amax();
        let rounding = (largest + self.mass * self.com.norm_squared()) * 1e-12;
        let moments = order.map(|k| principal.eigenvalues[k]).map(|moment| if moment.abs() <= rounding { 0.0 } else { moment });
        let is_apart = |a: usize, b: usize| (moments[a] - moments[b]).abs() > EQUAL * largest;
        let distinct = |axis: usize| is_apart(axis, (axis + 1) % 3) && is_apart(axis, (axis + 2) % 3);
        let turn = |axis: usize| {
            let (from, to) = (Vector3::ith(axis, 1.0), principal.eigenvectors.column(order[axis]));
            let across = from.cross(&to) * to[axis].signum();
            across.try_normalize(0.0).map_or(across, |about| about * along(order[axis], axis).min(1.0).acos().to_degrees())
        };
        let turns = (0..3).filter(|&axis| distinct(axis)).map(turn);
        (moments, turns.reduce(|most, turn| if turn.norm() > most.norm() + 1e-6 { turn } else { most }).unwrap_or_default())
    }
}

/// Moments that are nearer to each other than this part of the largest one are equal: the axis between them says nothing.
const EQUAL: f64 = 0.02;

/// Degrees: a smaller turn of a tensor is not said.
const LEAST_TURN: f64 = 1.0;

/// The angle of a turn and its axis, by name where it is nearly one of the frame.
fn turn(turn: &Vector3<f64>) -> String {
    let about = turn.normalize();
    let k = about.iamax();
    let about = match (about[k].abs() > 0.95, about[k] < 0.0) {
        (true, negative) => format!("{}{}", if negative { "-" } else { "" }, ["x", "y", "z"][k]),
        _ => format!("({:.1}, {:.1}, {:.1})", about.x, about.y, about.z),
    };
    format!("{:.0} deg about {about}", turn.norm())
}

/// A length beside others of size `scale`, where what is less than its rounding is 0.
fn small(value: f64, scale: f64) -> String {
    digits(if value.abs() < 1e-9 * scale { 0.0 } else { value })
}

/// The links with their bodies, and the load.
fn carriers(manipulator: &Manipulator) -> impl Iterator<Item = (String, &[PlacedBody])> {
    let links =
        manipulator.joints.iter().enumerate().map(|(i, joint)| (format!("{} {}", i + 1, joint.name), joint.link.as_slice()));
    let called = |of: Option<&str>| of.map_or_else(|| "payload".into(), |tip| format!("payload of {tip}"));
    links.chain(manipulator.loads().into_iter().map(move |load| (called(load.of), std::slice::from_ref(load.body))))
}

/// Mass and centre of mass, one row per link and one of the load. `distances` of the links come from `posture::distances`.
pub(super) fn masses(manipulator: &Manipulator, distances: &[[Option<f64>; 2]]) -> String {
    use Align::{Left, Point};
    let mut masses = Table::new([
        ("link", Left),
        ("mass (kg)", Point),
        ("com x (m)", Point),
        ("y", Point),
        ("z", Point),
        (TO_ITS_AXIS, Point),
        (NEXT_AXIS, Point),
    ]);
    let distances = distances.iter().copied().chain([[None; 2]]);
    for ((name, parts), distances) in carriers(manipulator).zip(distances) {
        let [to_axis, next] = distances.map(|distance| distance.map_or(String::new(), |x| small(x, 1.0)));
        match Solid::of(manipulator, parts) {
            None => masses.row([name, "0".into(), String::new(), String::new(), String::new(), to_axis, next]),
            Some(solid) => {
                let [x, y, z] = solid.com.data.0[0].map(digits);
                masses.row([name, digits(solid.mass), x, y, z, to_axis, next]);
            }
        }
    }
    match manipulator.is_massless() {
        true => masses.text(),
        false => masses.text() + &of_masses(&masses, manipulator),
    }
}

/// The inertias; `None` for an arm without mass. A link's moments have the order of its own axes, not of their size, so exchanged moments
/// show in the sides of the box.
pub(super) fn inertias(manipulator: &Manipulator) -> Option<String> {
    use Align::{Left, Point};
    let mut inertias = Table::new([
        ("link", Left),
        ("I x (kg m²)", Point),
        ("y", Point),
        ("z", Point),
        (TURNED, Left),
        (GYRATION, Point),
        ("box x (m)", Point),
        ("y", Point),
        ("z", Point),
        (DENSITY, Point),
    ]);
    let mut doubts: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (name, parts) in carriers(manipulator) {
        let Some(solid) = Solid::of(manipulator, parts) else { continue };
        let (moments, turned) = solid.moments();
        let [xx, yy, zz] = moments.map(digits);
        let largest = moments.iter().copied().fold(0.0, f64::max);
        let turned = if turned.norm() < LEAST_TURN { String::new() } else { turn(&turned) };
        let [a, b, c] = sides(solid.mass, &moments);
        let density = density_of_cuboid(solid.mass, [moments[0], 0.0, moments[1], 0.0, 0.0, moments[2]]);
        if let Some(words) = density.and_then(doubt_of_density) {
            doubts.entry(words).or_default().push(name.clone());
        }
        let density = density.map_or_else(String::new, |density| rounded(density).to_string());
        inertias.row([name, xx, yy, zz, turned, short((largest / solid.mass).sqrt()), a, b, c, density]);
    }
    if manipulator.is_massless() {
        return None;
    }
    let doubts: String = doubts.into_iter().map(|(words, links)| format!("  {words}: {}\n", links.join(", "))).collect();
    Some(inertias.text() + &of_inertias(&inertias) + &doubts)
}

const TO_ITS_AXIS: &str = "to its axis (m)";
const NEXT_AXIS: &str = "next axis (m)";
const TURNED: &str = "turned";
const GYRATION: &str = "gyration (m)";
const DENSITY: &str = "kg/m³";

/// The meaning of the columns of the masses.
fn of_masses(masses: &Table, manipulator: &Manipulator) -> String {
    let if_shown = |column: &str, words| if masses.shows(column) { words } else { "" };
    legend(&[
        if !manipulator.loads().is_empty() {
            "com: in the link's own frame, that of the payload in the end effector's"
        } else {
            "com: in the link's own frame"
        },
        if_shown(TO_ITS_AXIS, "to its axis: distance of the com from the axis of the joint that moves the link"),
        if_shown(NEXT_AXIS, "next axis: distance from that axis to the next joint's, after the last link to the end effector"),
    ])
}

/// The meaning of the columns of the inertias.
fn of_inertias(inertias: &Table) -> String {
    let if_shown = |column: &str, words| if inertias.shows(column) { words } else { "" };
    legend(&[
        "principal moments about the centre of mass, each at the axis of the link's frame that it is nearest to",
        if_shown(TURNED, "turned: angle between the link frame and the principal axes"),
        "gyration: radius of gyration sqrt(I/m) of the largest moment",
        "box: the cuboid of even density that has these moments",
        if_shown(DENSITY, "kg/m³: the density of the box; metal has up to 8000 kg/m³"),
    ])
}

/// The sides of the homogeneous cuboid with these moments about its centre: I_x = m (y² + z²) / 12. A body that violates the triangle
/// inequality has no such cuboid.
fn sides(mass: f64, moments: &[f64; 3]) -> [String; 3] {
    let sum: f64 = moments.iter().sum();
    if sum == 0.0 {
        return ["a point".into(), String::new(), String::new()];
    }
    let rounding = sum * 1e-9;
    let squares = squared_sides(mass, moments);
    if squares.iter().any(|square| square * mass < -6.0 * rounding) {
        return ["no box".into(), String::new(), String::new()];
    }
    let is_none = |square: f64| square * mass <= 6.0 * rounding;
    squares.map(|square| if is_none(square) { "0".into() } else { rounded(square.sqrt()).to_string() })
}

fn squared_sides(mass: f64, moments: &[f64; 3]) -> [f64; 3] {
    let sum: f64 = moments.iter().sum();
    moments.map(|moment| 6.0 * (sum - 2.0 * moment) / mass)
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
        match (sign, axis) {
            ("-", 2) => format!("{along} points up, so the arm hangs"),
            ("", 2) => format!("{along} points up"),
            _ => format!("{along} points up: z0 is horizontal"),
        }
    } else {
        format!("up is {} off {along}", degrees(off))
    }
}

fn degrees(angle: f64) -> String {
    format!("{} degrees", short(angle))
}

/// Four digits.
pub(super) fn short(value: f64) -> String {
    number::short(value, 4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_is_said_in_words() {
        assert_eq!(up([0.0, 0.0, -9.81]), "z0 points up");
        assert_eq!(up([0.0, 0.0, 9.81]), "-z0 points up, so the arm hangs");
        assert_eq!(up([0.0, 9.81, 0.0]), "-y0 points up: z0 is horizontal");
        assert_eq!(up([0.0; 3]), "none: the arm moves in a horizontal plane, or in free fall");
        assert_eq!(up([0.0, -9.81 * 0.5, -9.81 * 0.75f64.sqrt()]), "up is 30 degrees off z0");
    }

    /// 1 kg, 0.3 m by 0.2 m by 0.1 m; a rod; moments of no body.
    #[test]
    fn moments_are_those_of_a_box() {
        assert_eq!(sides(1.0, &[0.05 / 12.0, 0.1 / 12.0, 0.13 / 12.0]), ["0.3", "0.2", "0.1"]);
        assert_eq!(sides(12.0, &[4.0, 0.0, 4.0]), ["0", "2", "0"]);
        assert_eq!(sides(1.0, &[0.1, 0.1, 0.5])[0], "no box");
        assert_eq!(sides(3.0, &[0.0; 3])[0], "a point");
    }

    /// A box along x that is turned by 20 degrees about z; then exchanged moments; then a disc, whose axes in its plane may be any.
    #[test]
    fn moments_stand_at_the_axes_of_the_frame() {
        let solid = |inertia: Matrix3<f64>| Solid { mass: 1.0, com: Vector3::zeros(), inertia };
        let box_ = Matrix3::from_diagonal(&Vector3::new(1.0, 5.0, 5.5));
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), 20f64.to_radians());
        let (moments, turned) = solid(turn * box_ * turn.inverse()).moments();
        assert!((moments[0] - 1.0).abs() < 1e-9 && (moments[2] - 5.5).abs() < 1e-9, "{moments:?}");
        assert!((turned - Vector3::new(0.0, 0.0, 20.0)).norm() < 1e-6, "{turned}");
        assert_eq!(super::turn(&turned), "20 deg about z");
        // Its product of inertia with the other sign: it is turned the other way.
        let mut other = turn * box_ * turn.inverse();
        other[(0, 1)] = -other[(0, 1)];
        other[(1, 0)] = -other[(1, 0)];
        assert_eq!(super::turn(&solid(other).moments().1), "20 deg about -z");
        assert_eq!(super::turn(&Vector3::new(3.0, 3.0, 0.0)), "4 deg about (0.7, 0.7, 0.0)");
        assert_eq!(solid(Matrix3::from_diagonal(&Vector3::new(5.0, 1.0, 5.5))).moments(), ([5.0, 1.0, 5.5], Vector3::zeros()));
        let disc = Matrix3::new(1.0, 1e-6, 0.0, 1e-6, 1.0, 0.0, 0.0, 0.0, 2.0);
        assert_eq!(solid(disc).moments().1, Vector3::zeros());
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
