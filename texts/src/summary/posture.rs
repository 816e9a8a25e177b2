//! The arm at q = 0: its frames, axes and centres of mass, and the gravity torques of its joints. A comparison with a drawing shows a wrong
//! sign, row or frame of the file.
//!
//! ```text
//! T_i = T_(i-1) * before_i * motion_i(q_i) * after_i                link frame i in the base frame (Siciliano et al., Eq. 2.50)
//! g_i = -Σ_k m_k g0' (z_i × (p_k - o_i))   or   -Σ_k m_k g0' z_i    over the masses that joint i moves (Eq. 7.39)
//! ```

use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::exact::{Number, Polynomial};
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::{Joint, LinkId, Manipulator, PlacedBody, Placement, Pose};
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

use super::bodies::{short, Solid};
use super::digits;
use armgen_terminal::table::{Align, Table};

/// Smaller numbers are rounding, compared with 1.
const ROUNDING: f64 = 1e-9;

/// The frames of an arm as numbers: the poses before and after the motion of each joint, and its axis.
pub(super) struct Frames {
    joints: Vec<Step>,
    /// The end effectors: their names, the links that carry them, and their frames there.
    ends: Vec<(String, usize, Isometry3<f64>)>,
}

/// From the frame of the link that carries a joint to that of the link that it moves.
struct Step {
    parent: Option<usize>,
    before: Isometry3<f64>,
    axis: Unit<Vector3<f64>>,
    kind: JointKind,
    after: Isometry3<f64>,
}

impl Frames {
    pub(super) fn of(manipulator: &Manipulator) -> Frames {
        let step = |joint: &Joint| Step {
            parent: joint.parent.map(|link| link.index()),
            before: isometry(manipulator, &joint.row.before.frame),
            axis: Unit::new_normalize(Vector3::from(joint.row.axis.each_ref().map(Number::to_f64))),
            kind: joint.kind,
            after: isometry(manipulator, &joint.row.after.frame),
        };
        let names = manipulator.tips.iter().map(|tip| format!("end effector {}", tip.name));
        let names = names.chain(manipulator.tips.is_empty().then(|| "end effector".to_owned()));
        let end = |(name, (link, tool)): (String, (usize, &Pose))| (name, link, isometry(manipulator, &tool.frame));
        let ends = names.zip(manipulator.ends()).map(end).collect();
        Frames { joints: manipulator.joints.iter().map(step).collect(), ends }
    }

    /// The arm at joint variables.
    pub(super) fn at(&self, q: &[f64]) -> Posture {
        let (mut links, mut axes) = (Vec::<Isometry3<f64>>::new(), Vec::new());
        for (step, q) in self.joints.iter().zip(q) {
            let before = step.parent.map_or_else(Isometry3::identity, |link| links[link]) * step.before;
            axes.push(Axis { direction: before * step.axis, point: before * Point3::origin() });
            let motion = match step.kind {
                JointKind::Revolute => Isometry3::rotation(step.axis.scale(*q)),
                JointKind::Prismatic => Translation3::from(step.axis.scale(*q)).into(),
            };
            links.push(before * motion * step.after);
        }
        let ends = self.ends.iter().map(|(name, link, tool)| (name.clone(), *link, links[*link] * tool)).collect();
        Posture { links, axes, ends }
    }
}

/// An arm at some joint variables, in the base frame.
pub(super) struct Posture {
    links: Vec<Isometry3<f64>>,
    pub(super) axes: Vec<Axis>,
    /// The end effectors: their names, the links that carry them, and their frames.
    ends: Vec<(String, usize, Isometry3<f64>)>,
}

/// The axis of a joint.
pub(super) struct Axis {
    pub(super) direction: Unit<Vector3<f64>>,
    pub(super) point: Point3<f64>,
}

impl Axis {
    /// How far a point is from it.
    fn from(&self, point: &Point3<f64>) -> f64 {
        (point - self.point).cross(&self.direction).norm()
    }

    /// How far apart two axes are: |z × z' · (p' - p)| / |z × z'|, and where they are parallel the distance of a point of one from the other.
    fn to(&self, other: &Axis) -> f64 {
        let across = self.direction.cross(&other.direction);
        match across.norm() {
            sine if sine < ROUNDING => self.from(&other.point),
            sine => (across.dot(&(other.point - self.point)) / sine).abs(),
        }
    }
}

impl Posture {
    /// The place of the first end effector.
    pub(super) fn flange(&self) -> Vector3<f64> {
        self.ends[0].2.translation.vector
    }

    fn at_zero(manipulator: &Manipulator) -> Posture {
        let variables = manipulator.coupling.iter().flat_map(|coupling| &coupling.variables);
        let mut q: Vec<f64> = variables.map(|variable| variable.offset.to_f64()).collect();
        q.resize(manipulator.joints.len(), 0.0);
        Frames::of(manipulator).at(&q)
    }

    /// Mass and centre of mass of bodies in a frame, in the base frame; none without mass.
    fn placed(manipulator: &Manipulator, frame: &Isometry3<f64>, parts: &[PlacedBody]) -> Option<(f64, Point3<f64>)> {
        Solid::of(manipulator, parts).map(|solid| (solid.mass, frame * Point3::from(solid.com)))
    }

    fn of_link(&self, manipulator: &Manipulator, link: usize) -> Option<(f64, Point3<f64>)> {
        Posture::placed(manipulator, &self.links[link], &manipulator.joints[link].link)
    }

    /// The masses on a link: itself, the load, and the rotors that it carries.
    fn masses<'a>(&'a self, manipulator: &'a Manipulator, link: usize) -> impl Iterator<Item = (f64, Point3<f64>)> + 'a {
        let is_here = move |id: LinkId| id.index() == link;
        let loads = manipulator.loads().into_iter().filter(move |load| load.link == link);
        let loads = loads.filter_map(move |load| {
            let end = self.links[link] * isometry(manipulator, &load.tool.frame);
            Posture::placed(manipulator, &end, std::slice::from_ref(load.body))
        });
        let motors = manipulator.joints.iter().filter_map(|joint| joint.motor.as_ref());
        let rotors = motors.filter(move |motor| motor.carrier.is_some_and(is_here)).map(move |motor| {
            let place = Point3::from(motor.position.each_ref().map(|x| number(manipulator, x)));
            (number(manipulator, &motor.mass), self.links[link] * place)
        });
        self.of_link(manipulator, link).into_iter().chain(loads).chain(rotors)
    }

    /// The torque or force of joint `i` that holds the arm against gravity; springs are not counted.
    fn gravity(&self, manipulator: &Manipulator, i: usize) -> f64 {
        let g0 = Vector3::from(manipulator.gravity.each_ref().map(|x| number(manipulator, x)));
        let Axis { direction, point } = &self.axes[i];
        let moved = (i..manipulator.joints.len()).filter(|&link| is_moved_by(manipulator, link, i));
        let terms = moved.flat_map(|link| self.masses(manipulator, link)).map(|(mass, com)| match manipulator.joints[i].kind {
            JointKind::Revolute => mass * g0.dot(&direction.cross(&(com - point))),
            JointKind::Prismatic => mass * g0.dot(direction),
        });
        -terms.sum::<f64>()
    }
}

/// Whether joint `i` moves `link`.
fn is_moved_by(manipulator: &Manipulator, link: usize, i: usize) -> bool {
    std::iter::successors(Some(link), |&link| manipulator.joints[link].parent.map(|parent| parent.index())).any(|link| link == i)
}

fn number(manipulator: &Manipulator, value: &Polynomial) -> f64 {
    nominal(manipulator, value).to_f64()
}

fn isometry(manipulator: &Manipulator, frame: &Placement) -> Isometry3<f64> {
    let turn = Matrix3::from_fn(|i, j| frame.rotation[i][j].to_f64());
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn));
    let place = Vector3::from(frame.translation.each_ref().map(|x| number(manipulator, x)));
    Isometry3::from_parts(Translation3::from(place), turn)
}

/// How far the centre of mass of a link, none without mass, is from the axis of its joint, and the next axis from that; of the last one the end
/// effector. Both are the same at all q, and of no meaning for a slide, whose axis can be drawn anywhere.
pub(super) fn distances(manipulator: &Manipulator) -> Vec<[Option<f64>; 2]> {
    let posture = Posture::at_zero(manipulator);
    let turns = |i: usize| manipulator.joints[i].kind == JointKind::Revolute;
    let of = |i: usize| {
        let axis = &posture.axes[i];
        let next =
            (i + 1..manipulator.joints.len()).find(|&next| manipulator.joints[next].parent.is_some_and(|link| link.index() == i));
        let next = match next {
            Some(next) => turns(next).then(|| axis.to(&posture.axes[next])),
            None => {
                let end = posture.ends.iter().find(|(_, link, _)| *link == i);
                end.map(|(_, _, frame)| axis.from(&frame.translation.vector.into()))
            }
        };
        match turns(i) {
            true => [posture.of_link(manipulator, i).map(|(_, com)| axis.from(&com)), next],
            false => [None, None],
        }
    };
    (0..manipulator.joints.len()).map(of).collect()
}

/// The frames of the links at q = 0.
pub(super) fn frames(manipulator: &Manipulator) -> String {
    use Align::Left;
    let posture = Posture::at_zero(manipulator);
    let mut frames = Table::new([
        ("at q = 0", Left),
        ("joint axis", Left),
        ("link frame at (m)", Left),
        ("its x axis", Left),
        ("its z axis", Left),
    ]);
    let mut row = |name: String, axis: String, frame: &Isometry3<f64>| {
        let along = |axis: Unit<Vector3<f64>>| direction(&(frame * axis));
        frames.row([name, axis, point(&frame.translation.vector), along(Vector3::x_axis()), along(Vector3::z_axis())]);
    };
    row("base frame".into(), String::new(), &Isometry3::identity());
    for (i, (joint, axis)) in manipulator.joints.iter().zip(&posture.axes).enumerate() {
        row(format!("{} {}", i + 1, joint.name), direction(&axis.direction), &posture.links[i]);
    }
    posture.ends.iter().for_each(|(name, _, frame)| row(name.clone(), String::new(), frame));
    frames.text() + "  all in the base frame\n"
}

/// Where the axes and centres of mass are at q = 0, and what gravity asks of each joint.
pub(super) fn carried(manipulator: &Manipulator) -> String {
    use Align::{Left, Right};
    // A drive holds what all joints that move with it carry: the function `gravity` has that.
    let has_torques = manipulator.coupling.is_none() && !manipulator.is_massless();
    let posture = Posture::at_zero(manipulator);
    let mut carried = Table::new([("at q = 0", Left), ("joint axis", Left), ("centre of mass (m)", Left), ("gravity", Right)]);
    let mut weak = Vec::new();
    for (i, (joint, axis)) in manipulator.joints.iter().zip(&posture.axes).enumerate() {
        let unit = if joint.kind == JointKind::Revolute { "N m" } else { "N" };
        let held = posture.gravity(manipulator, i);
        // As small as what sums of such numbers round by.
        let held = if held.abs() < ROUNDING { 0.0 } else { held };
        let effort = joint.limits.effort.as_ref().map(Number::to_f64);
        if let Some(effort) = effort.filter(|effort| has_torques && held.abs() > *effort) {
            weak.push(format!("{} ({} {unit})", joint.name, short(effort)));
        }
        carried.row([
            format!("{} {}", i + 1, joint.name),
            direction(&axis.direction),
            posture.of_link(manipulator, i).map_or(String::new(), |(_, com)| point(&com.coords)),
            if has_torques { format!("{} {unit}", short(held)) } else { String::new() },
        ]);
    }
    for (name, _, frame) in &posture.ends {
        carried.row([name.clone(), String::new(), format!("at {}", point(&frame.translation.vector)), String::new()]);
    }
    let held = match has_torques {
        true => "; gravity: the torque or force that the motor must give to hold this posture, springs excluded",
        false if manipulator.coupling.is_some() => "; q: the coordinates",
        false => "",
    };
    let legend = super::legend(&[format!("in the base frame{held}").as_str()]);
    let weak = match weak.is_empty() {
        true => String::new(),
        false => format!("  that is more than the effort limit of {}\n", weak.join(", ")),
    };
    carried.text() + &legend + &weak + &outside(manipulator)
}

/// A line where the posture is outside the limits of joints.
fn outside(manipulator: &Manipulator) -> String {
    let zero = |[low, high]: &[Number; 2]| low.to_f64() <= 0.0 && 0.0 <= high.to_f64();
    let coordinates = manipulator.coordinates().into_iter();
    let outside = coordinates.filter(|of| of.limits.position.as_ref().is_some_and(|position| !zero(position)));
    let names: Vec<&str> = outside.map(|of| of.joint.name.as_str()).collect();
    match names.is_empty() {
        true => String::new(),
        false => format!("  q = 0 is outside the limits of {}\n", names.join(", ")),
    }
}

/// Three numbers in brackets.
fn point(place: &Vector3<f64>) -> String {
    let number = |x: f64| if x.abs() < ROUNDING { "0".to_owned() } else { digits(x) };
    format!("({}, {}, {})", number(place.x), number(place.y), number(place.z))
}

/// A direction by its name where it is along an axis of the base.
fn direction(direction: &Vector3<f64>) -> String {
    let largest = direction.iamax();
    if (direction[largest].abs() - 1.0).abs() < ROUNDING {
        let sign = if direction[largest] < 0.0 { "-" } else { "" };
        return format!("{sign}{}0", ["x", "y", "z"][largest]);
    }
    point(direction)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arm(text: &str) -> Manipulator {
        armgen_codegen::validate::read(&armgen_codegen::source::Source::new("a.yaml", text)).0.expect("it is valid").0
    }

    /// A rod of 2 kg that lies along x0 and a slide along z0 that carries it: m g l/2 is what the hinge holds, m g the slide.
    #[test]
    fn what_is_held_is_weight_times_arm() {
        let manipulator = arm("name: a\nconvention: standard\ngravity: [0, 0, -10]\njoints:\n  - {name: s, type: prismatic, a: 0, alpha: pi/2, d: 0, theta: 0, link: {mass: 0}}\n  \
             - {name: h, type: revolute, a: 1, alpha: 0, d: 0, theta: 0, link: {mass: 2, com: [-0.5, 0, 0], inertia: {yy: 1/6, zz: 1/6}}}\n\
             tool: {xyz: [0, 0.25, 0]}\n");
        let posture = Posture::at_zero(&manipulator);
        assert!((posture.gravity(&manipulator, 0) - 20.0).abs() < 1e-12);
        assert!((posture.gravity(&manipulator, 1) - 10.0).abs() < 1e-12);
        let text = carried(&manipulator);
        assert!(text.contains("2 h") && text.contains("-y0") && text.contains("10 N m"), "{text}");
        assert!(text.contains("end effector") && text.contains("(1, 0, 0.25)"), "{text}");
    }

    /// 10 m/s² at 1 kg, 1 m from the axis: 10 N m.
    #[test]
    fn an_effort_limit_below_what_is_held_is_said() {
        let of = |effort: &str| {
            let link = "link: {mass: 1, inertia: {xx: 1, yy: 1, zz: 1}}";
            carried(&arm(&format!("name: a\nconvention: standard\ngravity: [0, -10, 0]\njoints:\n  - {{name: elbow, type: revolute, a: 1, alpha: 0, d: 0, theta: 0, {link}, limits: {{effort: {effort}}}}}\n")))
        };
        assert!(of("9").ends_with("\n  that is more than the effort limit of elbow (9 N m)\n"), "{}", of("9"));
        assert!(!of("11").contains("effort"));
    }

    #[test]
    fn a_posture_outside_the_limits_is_said_to_be() {
        let of = |limits: &str| {
            let row = "type: revolute, a: 1, alpha: 0, d: 0, theta: 0, link: {mass: 1}";
            carried(&arm(&format!("name: a\nconvention: standard\ngravity: [0, 0, -10]\njoints:\n  - {{name: elbow, {row}, limits: {{position: {limits}}}}}\n")))
        };
        assert!(of("[1, 2]").contains("\n  q = 0 is outside the limits of elbow\n"));
        assert!(!of("[0, 2]").contains("outside"));
    }
}
