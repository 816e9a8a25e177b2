//! Values that can be, but hardly are meant: wrong units, wrong sides of a gear, points that no data sheet has.
//!
//! Each threshold asks what no arm does, not what most do; what passes them may still be wrong.
//!
//! | kind | warns of | since |
//! |---|---|---|
//! | `implausible-reach` | a length, all lengths together, or a limit of a slide beyond 30 m | the longest arms, of space stations and concrete pumps, have links of some 10 m; 0.05 m written in mm is 50 |
//! | the same | a row's length of more than five times all others together that would be one of them in cm or mm | a point lost in one row |
//! | `implausible-mass` | masses of more than 2000 kg per cube of what the arm spans | industrial arms have 3 to 80; a solid cube of that side made of light alloy has 2700 |
//! | the same | a payload of five times the mass of all links and motors, under gravity | hydraulic arms lift some four times their own |
//! | the same | a rotor that weighs more than all links | motors are parts of arms |
//! | `outlying-mass` | a link of five times the mass of all others together, unless its inertia is that of a body of such a mass: that of a ball less dense than light alloy | the heaviest links of arms have about half of the whole; a torso below a head has more, but its inertia says so, too, and a slip of ten in a mass makes the ball 316 times as dense |
//! | `implausible-com` | a centre of mass farther from its frame than the arm is long | it lies within its link; a payload is no longer than the arm |
//! | `implausible-inertia` | a radius of gyration above what the link, or for a payload the arm, spans | two point masses at the ends of a rod have half; files that are much in use have up to 0.95 |
//! | `placeholder-inertia` | the same: a tensor of which xx, yy and zz are one number that is a power of ten or that another link has, too | no two links of an arm are balls of one inertia; templates say 1 1 1 or 0.001 three times |
//! | `implausible-density` | an inertia below half of that of a lead ball of the link's mass | of all bodies of one mass and density a ball has the least |
//! | both, of all links together | a median density of their boxes below that of rigid foam, or above that of lead: all tensors ten times too large or too small, which each of them alone may be | of 46 files that are much in use 42 have 320 to 5600 kg/m³, and the others values that nobody measured |
//! | `missing-inertia` | no inertia on a link of a twentieth of the arm's mass | a point mass has none, and no link is one |
//! | `reflected-rotor` | a rotor that weighs more at its joint, ratio² I, than three times the whole arm at its reach | gears are chosen to match |
//! | `implausible-armature` | the same of an armature | |
//! | `inverted-ratio` | a ratio below 1/5 | gears of arms slow down: rotor speed over joint speed is at least 1 |
//! | `implausible-gravity` | a size that no planet or moon of a lander has, to 2 in 100 | tables of planets |
//! | `implausible-velocity` | a limit beyond 60 rad/s or 20 m/s | the fastest wrists of packing robots turn at 35, legs without much of a gear at 52; the slowest arms make 60 degrees per second |
//! | the same | from 30 rad/s on a whole multiple of five; a whole number eight times as large as the limits of all other joints | a limit in degrees per second among some in rad/s |
//! | `implausible-effort` | an effort limit of 300 times what holds the whole arm at its reach | the strongest legs have some ten times |
//! | `implausible-friction` | friction of five times what holds the whole arm at its reach, at 1 rad/s; a load friction above 2; Stribeck friction that fades beyond the velocity limit, 10 rad/s or 1 m/s | such a joint would not move; Stribeck friction is one of creeping |
//! | `weak-effort` | an effort limit below half of what gravity asks for in some posture, without a spring | such an arm falls |
//! | the same | an effort limit that dry friction alone takes | a joint with it does not move; motors' torques are given before the gear, friction behind it |
//! | `active-friction` | friction that drives the joint somewhere below its velocity limit | friction takes energy; fits to noisy measurements do not know that |
//! | `dust` | a length or an angle that is not 0 but below 1e-9 | less than the size of an atom at any reach; exact equations carry it along |

mod densities;
mod drives;
mod frames;
mod holding;
mod slips;

use super::{call, Context};
use crate::description::{BodyDescription, JointDescription, PoseDescription, RobotDescription, RotationDescription, Value};
use crate::diagnostic::{Code, Diagnostic};
use crate::document::Expression;
use crate::kinds::JointKind;
use crate::source::Span;
pub use densities::{density_of_cuboid, doubt_of_density};
use drives::{check_acceleration, check_effort, check_friction, check_velocity};
use frames::check_reference;
pub(super) use holding::check_holding;
use slips::{in_text, likely_tensors, single_slip, written_as};

const LONGEST: f64 = 30.0;
const MASS_PER_CUBE: f64 = 2000.0;
const OUTLYING: f64 = 5.0;
/// No arm carries so many times its own mass.
const HEAVIEST_LOAD: f64 = 2.0;
const LEAD: f64 = 11_340.0;
const LIGHT_ALLOY: f64 = 2700.0;
const OF_LEAD_BALL: f64 = 0.5;
/// The fewest other lengths that show a usual length of the arm.
const FEWEST_LENGTHS: usize = 3;
const HEAVY_PART: f64 = 0.05;
const REFLECTED: f64 = 3.0;
const LEAST_RATIO: f64 = 0.2;
const FASTEST_TURN: f64 = 60.0;
const FASTEST_SLIDE: f64 = 20.0;
const DUST: f64 = 1e-9;
/// Shorter arms, m, are examples: nothing follows from their size.
const SMALL_REACH: f64 = 0.05;
/// The extent of a link beyond its frames and twice its centre of mass, m: flanges, housings, counterweights.
const HOUSING: f64 = 0.2;
/// Sizes of gravity, m/s², of bodies where arms may work, and their names.
const GRAVITIES: [f64; 10] = [1.352, 1.62, 3.7, 8.87, 9.81, 10.0, 8.69, 10.44, 11.15, 24.79];
const GRAVITY_PART: f64 = 0.02;

/// Data about all joints together.
struct Arm<'d> {
    joints: &'d [JointDescription],
    /// The joint that carries each one.
    parents: &'d [Option<usize>],
    /// |a| + |d| of each row, m, and of its origin and its mount.
    lengths: Vec<f64>,
    /// How far each joint slides, m; infinite where it has no limits.
    strokes: Vec<f64>,
    /// Sum of these along the longest branch, with the tool, and of strokes where these are next to nothing; m.
    reach: f64,
    /// Masses of all links, kg.
    masses: Vec<f64>,
}

/// A body with mass whose numbers are looked at.
struct Body<'b> {
    description: &'b BodyDescription,
    /// kg.
    mass: f64,
    /// How messages call it.
    whose: String,
    /// The owner of the frame of its numbers.
    frame: &'static str,
    /// How far its centre of mass can be from there, m: the arm is as long.
    farthest: f64,
}

/// Warns of what is implausible in a description without errors.
/// `ends`: the link of each end effector, and its tool.
pub(super) fn check(
    description: &RobotDescription,
    parents: &[Option<usize>],
    ends: &[(usize, Option<&PoseDescription>)],
    context: &mut Context<'_>,
) {
    let Some(joints) = description.joints.as_ref().map(|list| list.value.as_slice()) else { return };
    check_branches(description, joints, parents, context);
    gravity(description, context);
    let mut lengths = Vec::new();
    for (i, joint) in joints.iter().enumerate() {
        let called = call(i, joint);
        let of = |(value, name): (&Value, &str), context: &mut Context<'_>| {
            length(value, &format!("`{name}` of joint {called}"), context)
        };
        let origin =
            joint.origin.as_ref().map_or(0.0, |pose| translation(pose, &format!("the origin of joint {called}"), context));
        let mount = joint.mount.as_ref().map_or(0.0, |pose| translation(pose, &format!("the mount of joint {called}"), context));
        lengths.push(of((&joint.a, "a"), context) + of((&joint.d, "d"), context) + origin + mount);
        for (value, name) in [(&joint.alpha, "alpha"), (&joint.theta, "theta")] {
            dust(value, &format!("`{name}` of joint {called}"), "rad", context);
        }
    }
    if let Some(base) = &description.base {
        translation(base, "the base", context);
    }
    check_outlying_length(joints, context);
    let tools = ends.iter().map(|(link, tool)| (*link, tool.map(|tool| (translation(tool, "the tool", context), tool.key))));
    let tools: Vec<_> = tools.filter_map(|(link, tool)| Some((link, tool?))).collect();
    // How far each joint is from the base at most, those of end effectors with the tool.
    let mut far: Vec<f64> = Vec::new();
    for (length, parent) in lengths.iter().zip(parents) {
        far.push(parent.map_or(0.0, |parent| far[parent]) + length);
    }
    let ends = tools.iter().map(|(link, (length, _))| far[*link] + length);
    let mut reach = far.iter().copied().chain(ends).fold(0.0, f64::max);
    let tool = tools.into_iter().map(|(_, tool)| tool).max_by(|a, b| a.0.total_cmp(&b.0));
    check_reach(joints, &lengths, tool, reach, context);
    let strokes: Vec<f64> = joints.iter().map(|joint| stroke(joint, context)).collect();
    if reach < 2.0 * SMALL_REACH {
        reach += strokes.iter().filter(|stroke| stroke.is_finite()).sum::<f64>();
    }
    let mass =
        |joint: &JointDescription, context: &mut Context<'_>| joint.link.as_ref().map_or(0.0, |link| number(&link.mass, context));
    let masses = joints.iter().map(|joint| mass(joint, context)).collect();
    let arm = Arm { joints, parents, lengths, strokes, reach, masses };
    let doubted = arm.check_masses(context);
    arm.check_axes(description.convention.as_ref().map(|convention| convention.value), context);
    let mut doubtful = doubted;
    for (i, joint) in joints.iter().enumerate() {
        let called = call(i, joint);
        if let Some(link) = &joint.link {
            doubtful |= arm.check_link(i, link, &called, doubted, context);
        }
        arm.check_motor(joint, &called, context);
        check_stroke(joint, &called, context);
        check_velocity(joint, &called, context);
        check_acceleration(joint, &called, context);
        check_effort(joint, &called, context);
        check_friction(joint, &called, context);
        if !doubted {
            arm.check_sizes(joint, &called, context);
        }
    }
    arm.check_rates(context);
    let loads = description.tips.iter().flat_map(|tips| &tips.value).filter_map(|tip| tip.payload.as_ref());
    for payload in description.payload.iter().chain(loads) {
        let weightless = !description.gravity_is_argument
            && description.gravity.as_ref().is_some_and(|g| g.value.iter().all(|g| number(g, context) == 0.0));
        arm.check_payload(payload, doubted, weightless, context);
    }
    if !doubtful {
        arm.check_densities(context);
    }
}

/// An arm with branches whose file does not name its end effector.
fn check_branches(
    description: &RobotDescription,
    joints: &[JointDescription],
    parents: &[Option<usize>],
    context: &mut Context<'_>,
) {
    let mut leaves = (0..joints.len()).filter(|i| !parents.contains(&Some(*i)));
    let (Some(leaf), Some(last), None, None) = (leaves.next(), leaves.next_back(), &description.tip, &description.tips) else {
        return;
    };
    let place = |i: usize| joints[i].name.as_ref().map_or(joints[i].span, |name| name.span);
    let [first, last] = [leaf, last].map(|i| (place(i), call(i, &joints[i])));
    let message = format!("the arm has several branches, and one end effector, on joint {}, the last of the list", last.1);
    let help = "name its joint by `tip`, or several end effectors by `tips: [{name: ..., joint: ...}, ...]`";
    let doubt = Diagnostic::new(Code::OneTip, last.0, message, "has the end effector", help);
    context.diagnostics.push(doubt.also(first.0, format!("joint {} ends a branch, too", first.1)));
}

/// The length of a pose's translations, m; warns of tiny angles and lengths.
fn translation(pose: &PoseDescription, what: &str, context: &mut Context<'_>) -> f64 {
    let mut whole = 0.0;
    for element in &pose.elements {
        let xyz = element.xyz.iter().flat_map(|xyz| xyz.value.iter());
        whole += xyz.map(|value| length(value, what, context).powi(2)).sum::<f64>().sqrt();
        if let Some(RotationDescription::Rpy(angles)) = &element.rotation {
            angles.value.iter().for_each(|value| dust(value, what, "rad", context));
        }
    }
    whole
}

/// How far a joint slides, m: 0 where it turns, infinite where it has no limits.
fn stroke(joint: &JointDescription, context: &mut Context<'_>) -> f64 {
    match (&joint.kind, &joint.limits.position) {
        (Some(kind), _) if kind.value == JointKind::Revolute => 0.0,
        (_, Some(limits)) => limits.value.iter().map(|value| number(value, context).abs()).sum(),
        (_, None) => f64::INFINITY,
    }
}

/// The value in the description; 0 if absent.
fn number(value: &Value, context: &mut Context<'_>) -> f64 {
    value.as_ref().and_then(|expression| context.number(expression)).map_or(0.0, |number| number.to_f64())
}

/// Where a value is written: at the definition where it is a name.
fn written(value: &Expression, context: &Context<'_>) -> Span {
    definition(value, context).span
}

/// The value itself, or the definition of the name that it is.
fn definition<'v>(value: &'v Expression, context: &'v Context<'_>) -> &'v Expression {
    value.as_name().and_then(|name| context.evaluator.parameters.get(name)).and_then(|entry| entry.value).unwrap_or(value)
}

/// The size of a length, m; warns of one that is too long, and of one that is next to nothing.
fn length(value: &Value, what: &str, context: &mut Context<'_>) -> f64 {
    dust(value, what, "m", context);
    let size = number(value, context);
    if let (true, Some(expression)) = (size.abs() > LONGEST, value) {
        let span = written(expression, context);
        let message = format!("{what} is {} m: longer than any arm", short(size.abs()));
        let help = in_text("lengths are in m", "mm", written_as(expression, 1000, context));
        context.report(Code::ImplausibleReach, span, message, "in mm?", help);
    }
    size.abs()
}

/// All lengths together, where none of them is too long by itself; `tool` has length and place of the tool's.
fn check_reach(joints: &[JointDescription], lengths: &[f64], tool: Option<(f64, Span)>, reach: f64, context: &mut Context<'_>) {
    let Some(longest) = (0..lengths.len()).reduce(|a, b| if lengths[b] > lengths[a] { b } else { a }) else { return };
    let is_told = context.diagnostics.iter().any(|diagnostic| diagnostic.code == Code::ImplausibleReach);
    if reach <= LONGEST || is_told {
        return;
    }
    let joint = &joints[longest];
    let rows = [&joint.a, &joint.d].map(|value| (number(value, context).abs(), value.as_ref()));
    let value = rows.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).and_then(|(_, value)| value);
    let of_joint = value.map(|value| written(value, context)).or(joint.origin.as_ref().map(|origin| origin.key));
    let span = tool.filter(|(length, _)| *length > lengths[longest]).map(|(_, key)| key).or(of_joint);
    let message = format!("the lengths of the arm add up to {} m: no arm is as long", short(reach));
    let help = format!("lengths are in m; if these are in cm, the arm is {} m long", short(reach / 1e2));
    context.report(Code::ImplausibleReach, span.unwrap_or(joint.span), message, "the longest; all in cm?", help);
}

/// One a or d that is longer than all others together, and in another unit of a length as theirs.
fn check_outlying_length(joints: &[JointDescription], context: &mut Context<'_>) {
    let mut all = Vec::new();
    for (i, joint) in joints.iter().enumerate() {
        for (value, name) in [(&joint.a, "a"), (&joint.d, "d")] {
            let size = number(value, context).abs();
            all.extend(value.as_ref().filter(|_| size > 0.0).map(|expression| (size, expression, name, call(i, joint))));
        }
    }
    let Some(longest) = (0..all.len()).reduce(|a, b| if all[b].0 > all[a].0 { b } else { a }) else { return };
    let (size, expression, name, called) = all.swap_remove(longest);
    let others = all.iter().map(|other| other.0);
    let (sum, least, most) =
        (others.clone().sum::<f64>(), others.clone().fold(f64::INFINITY, f64::min), others.fold(0.0, f64::max));
    if all.len() < FEWEST_LENGTHS || size <= OUTLYING * sum || size > LONGEST {
        return;
    }
    let fits = |factor: f64| (least..=most).contains(&(size / factor));
    let Some((factor, unit)) = [(100, "cm"), (1000, "mm")].into_iter().find(|(factor, _)| fits(f64::from(*factor))) else {
        return;
    };
    let message = format!("`{name}` of joint {called} is {} m, and all others together are {} m", short(size), short(sum));
    let help = in_text("lengths are in m", unit, written_as(expression, u64::from(factor as u32), context));
    context.report(Code::ImplausibleReach, written(expression, context), message, format!("in {unit}?"), help);
}

/// How far a joint slides: neither a length that no arm has nor an angle.
fn check_stroke(joint: &JointDescription, called: &str, context: &mut Context<'_>) {
    if joint.kind.as_ref().is_none_or(|kind| kind.value == JointKind::Revolute) {
        return;
    }
    for value in joint.limits.position.iter().flat_map(|limits| &limits.value) {
        let Some(expression) = value else { continue };
        let size = number(value, context);
        let span = written(expression, context);
        if is_in_degrees(expression, context) {
            let message = format!("a limit of joint {called} is an angle in degrees, and the joint slides");
            let help = "limits of a prismatic joint are in m; see whether the joint is `revolute`";
            context.report(Code::DegreesSuspected, span, message, "an angle?", help);
        } else if size.abs() > LONGEST {
            let message =
                format!("a limit of joint {called} is {} m from 0: no joint of an arm slides as far", short(size.abs()));
            let help = in_text("lengths are in m", "mm", written_as(expression, 1000, context));
            context.report(Code::ImplausibleReach, span, message, "in mm?", help);
        }
    }
}

/// Whether a value is an angle in degrees, by itself or by the name that it is.
fn is_in_degrees(value: &Expression, context: &Context<'_>) -> bool {
    definition(value, context).is_in_degrees()
}

fn dust(value: &Value, what: &str, unit: &str, context: &mut Context<'_>) {
    let size = number(value, context);
    if let (true, Some(expression)) = (size != 0.0 && size.abs() < DUST, value) {
        let span = written(expression, context);
        let message = format!("{what} is {size:e} {unit}: not 0, but next to nothing");
        let help = "write 0: exact equations carry the number along, at the cost of operations, and nothing comes of it";
        context.report(Code::Dust, span, message, "0?", help);
    }
}

fn gravity(description: &RobotDescription, context: &mut Context<'_>) {
    let Some(gravity) = &description.gravity else { return };
    let size = gravity.value.iter().map(|value| number(value, context).powi(2)).sum::<f64>().sqrt();
    let is_one = |size: f64| GRAVITIES.iter().any(|g| (size / g - 1.0).abs() < GRAVITY_PART);
    if size == 0.0 || is_one(size) {
        return;
    }
    let help = if size == 1.0 {
        "give the acceleration, not its direction alone: 9.81 times this".to_owned()
    } else if let Some((factor, unit)) =
        [(100.0, "cm/s²"), (1000.0, "mm/s²")].into_iter().find(|(factor, _)| is_one(size / factor))
    {
        format!("in m/s², not {unit}: the size would be {}", short(size / factor))
    } else {
        "on earth it is 9.81 m/s²; `[0, 0, -9.81]` where z0 points up".to_owned()
    };
    let message = format!("gravity of {} m/s² is that of no planet or moon", short(size));
    context.report(Code::ImplausibleGravity, gravity.span, message, "its size", help);
}

/// How far the bodies of a link lie from its frame, m: each as far beyond its centre of mass as that is from the frame.
fn extent(link: &BodyDescription, context: &mut Context<'_>) -> f64 {
    let mut size = |value: &Value| number(value, context).powi(2);
    let twice_com = |body: &BodyDescription, size: &mut dyn FnMut(&Value) -> f64| {
        2.0 * body.com.as_ref().map_or(0.0, |com| com.value.iter().map(size).sum::<f64>().sqrt())
    };
    let mut farthest = twice_com(link, &mut size);
    for other in &link.attached {
        let origins = other.origin.iter().flat_map(|pose| &pose.elements).filter_map(|element| element.xyz.as_ref());
        let mut there = twice_com(&other.body, &mut size);
        origins.for_each(|xyz| there += xyz.value.iter().map(&mut size).sum::<f64>().sqrt());
        farthest = farthest.max(there);
    }
    farthest
}

/// The largest of xx, yy and zz, kg m²; 0 where there is no tensor.
fn largest_moment(link: &BodyDescription, context: &mut Context<'_>) -> f64 {
    moments(link, context).into_iter().fold(0.0, f64::max)
}

/// xx, yy and zz of a link, kg m²; 0 where they are not given.
fn moments(link: &BodyDescription, context: &mut Context<'_>) -> [f64; 3] {
    let Some(inertia) = &link.inertia else { return [0.0; 3] };
    let [xx, _, yy, _, _, zz] = &inertia.elements;
    [xx, yy, zz].map(|value| number(value, context))
}

fn is_power_of_ten(value: f64) -> bool {
    let exponent = value.log10();
    (exponent - exponent.round()).abs() < 1e-9
}

/// The density, kg/m³, of the ball with this mass and moment of inertia; infinite without one.
fn density_of_ball(mass: f64, inertia: f64) -> f64 {
    // 2/5 m r².
    mass / (4.0 / 3.0 * std::f64::consts::PI * (2.5 * inertia.max(0.0) / mass).powf(1.5))
}

impl Arm<'_> {
    /// Whether masses are doubted: then nothing follows from them.
    fn check_masses(&self, context: &mut Context<'_>) -> bool {
        let total: f64 = self.masses.iter().sum();
        let Some(heaviest) = (0..self.masses.len()).reduce(|a, b| if self.masses[b] > self.masses[a] { b } else { a }) else {
            return true;
        };
        let Some(expression) = self.joints[heaviest].link.as_ref().and_then(|link| link.mass.as_ref()) else {
            return false;
        };
        let span = written(expression, context);
        let (mass, called) = (self.masses[heaviest], call(heaviest, &self.joints[heaviest]));
        let size =
            self.reach + self.joints.last().and_then(|joint| joint.link.as_ref()).map_or(0.0, |link| extent(link, context));
        // Where lengths are in mm they are told of, and masses may be in g as well.
        let in_mm = self.lengths.iter().any(|length| *length > LONGEST);
        let size = if in_mm && size > LONGEST { size / 1e3 } else { size };
        if self.reach > SMALL_REACH && total > MASS_PER_CUBE * size.powi(3) {
            let message = format!(
                "the links weigh {} kg, on an arm of {} m: more than solid metal; the heaviest is the link of joint {called}",
                short(total),
                short(size)
            );
            let help = in_text("masses are in kg, lengths in m", "g", written_as(expression, 1000, context));
            context.report(Code::ImplausibleMass, span, message, "in g?", help);
            return true;
        }
        let with_mass = self.masses.iter().filter(|mass| **mass > 0.0).count();
        let inertia = self.joints[heaviest].link.as_ref().map_or(0.0, |link| largest_moment(link, context));
        if with_mass > 2 && mass > OUTLYING * (total - mass) && density_of_ball(mass, inertia) > LIGHT_ALLOY {
            let message = format!(
                "the link of joint {called} weighs {} kg, {} times as much as all others together",
                short(mass),
                short((mass / (total - mass)).round())
            );
            let others = (total - mass) / (with_mass - 1) as f64;
            let off = |factor: f64| (mass / factor / others).ln().abs();
            let (help, label) = if off(1000.0) < off(10.0) {
                (in_text("masses are in kg", "g", written_as(expression, 1000, context)), "in g?")
            } else {
                let text = written_as(expression, 10, context);
                (
                    text.map_or_else(|| "masses are in kg".to_owned(), |text| format!("if a point has slipped, write {text}")),
                    "ten times off?",
                )
            };
            context.report(Code::OutlyingMass, span, message, label, help);
            return true;
        }
        false
    }

    /// Centre of mass and inertia of a link; whether it warns of a size of the inertia.
    fn check_link(&self, i: usize, link: &BodyDescription, called: &str, doubted: bool, context: &mut Context<'_>) -> bool {
        let mass = self.masses[i];
        // With bodies fixed to it the link is another than its own numbers say.
        if self.reach < SMALL_REACH || mass <= 0.0 || !link.attached.is_empty() {
            return false;
        }
        let body =
            Body { description: link, mass, whose: format!("the link of joint {called}"), frame: "link", farthest: self.reach };
        let Some(com) = check_com(&body, context) else { return false };
        if link.inertia.is_none() {
            let total: f64 = self.masses.iter().sum();
            // An arm without any inertia is one of point masses, and meant.
            let others = self.joints.iter().any(|joint| joint.link.as_ref().is_some_and(|link| link.inertia.is_some()));
            if others && mass > HEAVY_PART * total {
                let message = format!("the link of joint {called} weighs {} kg and has no inertia: it is a point", short(mass));
                let help = "give `inertia` about the centre of mass, or write `inertia: {}` if a point mass is meant";
                context.report(Code::MissingInertia, link.key, message, "no `inertia` below", help);
            }
            return false;
        }
        self.check_inertia(&body, self.span(i, com), doubted, context)
    }

    /// Mass, centre of mass and inertia of the payload. It may be longer than a link, and is not longer than the arm; where nothing has a
    /// weight it may have any mass.
    fn check_payload(&self, payload: &BodyDescription, doubted: bool, weightless: bool, context: &mut Context<'_>) {
        let mass = number(&payload.mass, context);
        let bodies = self
            .joints
            .iter()
            .filter_map(|joint| joint.link.as_ref())
            .flat_map(|link| std::iter::once(&link.mass).chain(link.attached.iter().map(|other| &other.body.mass)));
        let motors = self.joints.iter().filter_map(|joint| joint.motor.as_ref()).map(|motor| &motor.mass);
        let total: f64 = bodies.chain(motors).map(|mass| number(mass, context)).sum();
        if self.reach < SMALL_REACH || mass <= 0.0 {
            return;
        }
        let is_heavy = !doubted && !weightless && total > 0.0 && mass > HEAVIEST_LOAD * total;
        if let (true, Some(expression)) = (is_heavy, &payload.mass) {
            let span = written(expression, context);
            let message = format!(
                "the payload weighs {} kg, {} times as much as links and motors of the arm together",
                short(mass),
                short((mass / total).round())
            );
            let help = in_text("masses are in kg", "g", written_as(expression, 1000, context));
            context.report(Code::ImplausibleMass, span, message, "in g?", help);
        }
        let farthest = self.reach + self.strokes.iter().sum::<f64>();
        let body = Body { description: payload, mass, whose: "the payload".to_owned(), frame: "end effector", farthest };
        if let Some(com) = check_com(&body, context) {
            self.check_inertia(&body, farthest + 2.0 * com + HOUSING, doubted || is_heavy, context);
        }
    }

    /// The inertia of a body that can span so much; whether it warns of its size.
    fn check_inertia(&self, body: &Body<'_>, span: f64, doubted: bool, context: &mut Context<'_>) -> bool {
        let Body { description, mass, ref whose, .. } = *body;
        let largest = largest_moment(description, context);
        let Some(inertia) = description.inertia.as_ref().filter(|_| largest > 0.0) else { return false };
        check_reference(body, context);
        let gyration = (largest / mass).sqrt();
        if gyration > span {
            let message = format!(
                "the inertia of {whose} has a radius of gyration of {} m, more than the {} m that {} can span",
                short(gyration),
                short(span),
                if whose == "the payload" { "it" } else { "the link" }
            );
            let (code, label, help) = if self.has_placeholder(description, context) {
                let most = short(mass * span * span / 4.0);
                let help =
                    format!("write what the data sheet says: no body of {} kg in that span has more than {most}", short(mass));
                (Code::PlaceholderInertia, "a placeholder?".to_owned(), help)
            } else {
                let (label, meant) = match likely_tensors(inertia, mass, span, context) {
                    units if units.is_empty() => match single_slip(inertia, mass, span, context) {
                        Some((name, text)) => {
                            ("a decimal place off?".to_owned(), format!("if a point has slipped, write `{name}: {text}`"))
                        }
                        None => (
                            "too large".to_owned(),
                            format!("no single slip explains it: check this tensor and the mass, {} kg", short(mass)),
                        ),
                    },
                    units => {
                        let words: Vec<String> = units.iter().map(|(unit, _)| format!("in {unit}")).collect();
                        let meant: Vec<String> =
                            units.iter().map(|(unit, text)| format!("if this is in {unit}, write {text}")).collect();
                        (format!("{}?", words.join(" or ")), meant.join("; "))
                    }
                };
                (Code::ImplausibleInertia, label, format!("inertias are in kg m², about the centre of mass; {meant}"))
            };
            context.report(code, inertia.key, message, label, help);
        }
        // 2/5 m r² of the ball, r = (3 m / (4 pi rho))^(1/3).
        let radius = (3.0 * mass / (4.0 * std::f64::consts::PI * LEAD)).cbrt();
        let ball = 0.4 * mass * radius * radius;
        let too_small = largest < OF_LEAD_BALL * ball;
        if !doubted && too_small {
            let message = format!(
                "no solid of {} kg is as small as the inertia of {whose} says: a ball of lead has {} kg m²",
                short(mass),
                short(ball)
            );
            let help = format!(
                "check the mass (in kg) and the inertia (in kg m², about the centre of mass), of which the largest element is {}",
                short(largest)
            );
            context.report(Code::ImplausibleDensity, inertia.key, message, "too small", help);
        }
        gyration > span || too_small
    }

    /// Whether the tensor of a link comes from a template: three equal moments, each a power of ten or shared with another link.
    fn has_placeholder(&self, link: &BodyDescription, context: &mut Context<'_>) -> bool {
        let [xx, yy, zz] = moments(link, context);
        let links = self.joints.iter().filter_map(|joint| joint.link.as_ref());
        xx > 0.0 && xx == yy && yy == zz && {
            is_power_of_ten(xx) || links.filter(|other| moments(other, context) == [xx; 3]).count() > 1
        }
    }

    /// The span of the link of joint `i`, m: from the joint before it to the farthest of those that it carries, and about its centre of mass.
    fn span(&self, i: usize, com: f64) -> f64 {
        let part = |i: usize| self.lengths[i] + self.strokes[i];
        let carried = (i + 1..self.joints.len()).filter(|&next| self.parents[next] == Some(i));
        part(i) + carried.map(part).fold(0.0, f64::max) + 2.0 * com + HOUSING
    }
}

/// How far the centre of mass of a body is from its frame; `None` where it is farther than the arm is long, which is told.
fn check_com(body: &Body<'_>, context: &mut Context<'_>) -> Option<f64> {
    let Some(given) = &body.description.com else { return Some(0.0) };
    let Body { whose, frame, farthest, .. } = body;
    let mut com = 0.0;
    for value in &given.value {
        dust(value, &format!("the centre of mass of {whose}"), "m", context);
        com += number(value, context).powi(2);
    }
    com = com.sqrt();
    if com <= *farthest {
        return Some(com);
    }
    let message =
        format!("the centre of mass of {whose} is {} m from its frame, and the arm is {} m long", short(com), short(*farthest));
    let slips = [(1e3, "in mm"), (1e2, "in cm"), (10.0, "a decimal place off")];
    let (factor, slip) = likeliest(&slips, |factor| com / factor, 0.2 * farthest);
    let texts: Option<Vec<String>> =
        given.value.iter().map(|value| value.as_ref().and_then(|value| written_as(value, factor as u64, context))).collect();
    let meant = texts.map_or(String::new(), |texts| format!("if this is {slip}, write [{}]; ", texts.join(", ")));
    let help = format!("{meant}it counts from the {frame}'s frame");
    context.report(Code::ImplausibleCom, given.span, message, format!("{slip}?"), help);
    None
}

/// The slip with which a value comes nearest to what would be usual.
fn likeliest<'s>(slips: &[(f64, &'s str)], value: impl Fn(f64) -> f64, usual: f64) -> (f64, &'s str) {
    let off = |slip: &(f64, &str)| (value(slip.0) / usual).ln().abs();
    slips.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or((1.0, "a decimal place off"))
}

/// Units of inertias, by the factor that they make one too large.
const UNITS_OF_INERTIA: [(f64, &str); 4] = [(1e4, "in kg cm²"), (1e6, "in kg mm²"), (1e7, "in g cm²"), (1e9, "in g mm²")];
/// As far off the usual, in a radius of gyration, that a unit can still be meant: kg mm² and g cm² are a factor of √10 apart.
const AS_LIKELY: f64 = 4.0;

/// Four digits.
fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let digits = 3 - value.abs().log10().floor() as i32;
    if !(-4..=8).contains(&digits) {
        return format!("{value:.3e}");
    }
    let scale = 10f64.powi(digits);
    format!("{}", (value * scale).round() / scale)
}
