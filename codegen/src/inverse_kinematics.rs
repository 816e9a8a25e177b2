//! Inverse kinematics: the class of an arm, decided on its exact constants, and the constants of the construction that gives all its solutions.
//!
//! An arm and a pose close a loop, J1 L1 J2 L2 ... Jn Ln = 1, which may be read from any joint on and backwards (`chain`). Parallel and
//! intersecting axes make classes of arms whose solutions have closed forms (`classes`); any other arm of six joints is solved by the roots
//! of a determinant (`general`). The constructions themselves are the building blocks of `armgen-inverse-kinematics`, whose documentation has
//! the table of classes; here the arrangement of the loop that fits one is found.
//!
//! A class is decided exactly: 1e-9 is not 0. If its form does not show whether a number is 0, it counts as 0 if its enclosure
//! contains 0 and its value in a prime field is 0 (`frame`).

mod chain;
mod classes;
mod coordinates;
mod frame;
mod general;
mod jacobian;
mod steps;
mod virtual_joints;

use crate::exact::Number;
pub use crate::kinds::Target;
use crate::kinds::{JointKind, TaskRow};
use crate::manipulator::{GivenBeside, Manipulator, Tip};

pub use chain::{Arrangement, Given};
pub use classes::Regional;
pub use coordinates::{Coordinates, Sums};
pub use frame::Frame;

use chain::Chain;
use jacobian::Jacobian;

/// An end effector and how its postures are found.
#[derive(Clone, Debug)]
pub struct Solved {
    /// Its name; `None` where the arm has one end effector without a name.
    pub tip: Option<String>,
    /// The beginning of the names of its functions, `left_` of `left`; empty without a name.
    pub prefix: String,
    /// The arm; of a named end effector the part that moves it, whose coordinates are those of the postures.
    pub arm: Manipulator,
    /// The construction, or the reason why there is none.
    pub found: Result<InverseKinematics, String>,
}

impl Solved {
    /// All end effectors, in the order of the description.
    pub fn all(manipulator: &Manipulator) -> Vec<Solved> {
        match manipulator.tips.len() {
            0 => vec![Solved::of(manipulator.clone(), None)],
            count => (0..count).map(|tip| Solved::at(manipulator, tip)).collect(),
        }
    }

    /// One of the named end effectors.
    pub fn at(manipulator: &Manipulator, tip: usize) -> Solved {
        Solved::of(manipulator.arm_to(tip), Some(&manipulator.tips[tip]))
    }

    fn of(arm: Manipulator, tip: Option<&Tip>) -> Solved {
        Solved { found: of(&arm), arm, tip: tip.map(|tip| tip.name.clone()), prefix: tip.map_or_else(String::new, Tip::prefix) }
    }

    /// `of left` behind a noun; nothing where the end effector has no name.
    pub fn of_it(&self) -> String {
        self.tip.as_ref().map_or_else(String::new, |tip| format!(" of {tip}"))
    }

    /// Its name where functions have their names: `left_inverse_kinematics` of `left`.
    pub fn name(&self) -> String {
        format!("{}inverse_kinematics", self.prefix)
    }

    /// Class, steps and singular postures, or why there are none, as lines of text.
    pub fn text(&self) -> String {
        let name = self.name();
        match &self.found {
            Ok(found) => found.text().replacen("inverse_kinematics", &name, 1),
            Err(reason) => format!("{name}: none, {reason}\n"),
        }
    }

    /// Whether the description asks for it.
    pub fn is_asked_for(&self) -> bool {
        let asked = &self.arm.inverse_kinematics;
        asked.target.is_some() || asked.given.is_some()
    }

    /// The line at the head of its module that names the end effector and its coordinates; none where it has no name.
    pub fn head(&self) -> Option<String> {
        let tip = self.tip.as_ref()?;
        let names: Vec<&str> = self.arm.coordinates().iter().map(|of| of.joint.name.as_str()).collect();
        Some(format!("End effector: {tip}. Entries of q: {}.", names.join(", ")))
    }
}

/// Data of an arm from which all its solutions follow.
#[derive(Clone, Debug)]
pub struct InverseKinematics {
    /// The kind of its target.
    pub target: Target,
    /// The construction with its constants.
    pub construction: Construction,
    /// The class and the exact tests that it passes, for people.
    pub class: String,
    /// The largest number of solutions at a target with finitely many.
    pub most: usize,
    /// The choice behind each bit of a solution's branch: its place, the chosen quantity, the names of 0 and of 1.
    pub choices: Vec<Choice>,
    /// A length of the arm's size, m.
    pub length: Number,
    /// The redundancy of an arm with one joint more than its target needs.
    pub redundancy: Option<Redundancy>,
    /// The arm's own loop, if it has fewer joints than the pose has rows. It starts at joint 1; joints after the arm's last joint
    /// stay at 0. The construction belongs to the arm with virtual joints, whose values must be 0 in a solution.
    pub own: Option<Arrangement>,
    /// The coordinates of coupled joints. Everything else is of the chain of joints to the end effector and of their variables.
    pub coordinates: Option<Coordinates>,
}

/// The redundancy: a value that the caller gives with the target.
#[derive(Clone, Debug)]
pub enum Redundancy {
    /// The value of a joint.
    Joint(Box<Given>),
    /// The swivel angle of the elbow about the line from shoulder to wrist, rad. Documented with the block `shoulder_elbow_wrist`.
    Swivel,
}

/// One choice between the ways of a construction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// The lowest of its bits in the branch.
    pub bit: u32,
    /// The names of its ways; more than two where they are the roots of an equation.
    pub ways: Vec<String>,
    /// What tells the ways apart.
    pub meaning: String,
}

/// A construction and the arrangement of the loop that it is called with.
#[derive(Clone, Debug)]
pub enum Construction {
    /// Three neighbouring axes meet in one point.
    SphericalTriple(Arrangement, Regional),
    /// Three neighbouring axes are parallel; `bool`: the solutions are polished.
    ThreeParallel(Arrangement, bool),
    /// All revolute axes are parallel.
    ParallelTurns(Arrangement, Regional),
    /// Three prismatic joints; the places of the revolute ones.
    ThreePrismatic(Arrangement, [usize; 3]),
    /// Two prismatic joints, by their places.
    TwoSlides(Arrangement, [usize; 2]),
    /// The position that three joints reach.
    Position(Arrangement, Regional),
    /// Shoulder and wrist of three joints each about axes through a point, a joint between them; the swivel angle is given.
    ShoulderElbowWrist(Arrangement),
    /// Six joints of no class: two arrangements of the determinant.
    General(Box<[Arrangement; 2]>),
}

/// How all solutions of an arm are found, or why there is no function for that.
pub fn of(manipulator: &Manipulator) -> Result<InverseKinematics, String> {
    if !manipulator.tips.is_empty() {
        return Err("an arm with several end effectors has it of each of them".into());
    }
    if manipulator.coupling.is_some() {
        let coordinates = Coordinates::of(manipulator)?;
        let found = of(&manipulator.chain())?;
        let class = format!("{}; {}", found.class, coordinates.in_words());
        return Ok(InverseKinematics { class, coordinates: Some(coordinates), ..found });
    }
    let chain = Chain::of(manipulator)?;
    let length = size(&chain);
    let given = manipulator.inverse_kinematics.given;
    let (target, wanted) = target(manipulator, &chain)?;
    if chain.joints.len() == wanted + 1 {
        return redundant(&chain, target, &length, given);
    }
    if given.is_some() {
        return Err("`given` is for arms with one joint more than the target asks for".into());
    }
    if target == Target::Pose && always_moves(&chain) {
        return Err("at every pose some joints can move while the end effector stays".into());
    }
    if target == Target::Pose && chain.joints.len() < 6 {
        return virtual_joints::classify(&chain, &length);
    }
    classify(&completed(chain, target)?, None, target, &length)
}

/// Whether the columns of the Jacobian depend on each other at every posture.
fn always_moves(chain: &Chain) -> bool {
    Jacobian::of(chain, None).is_some_and(|jacobian| jacobian.rank(6) < chain.joints.len())
}

/// An arm with one joint more than its target needs. The description can name the given value. Otherwise it is the swivel angle,
/// if the arm has it, or the joint that leaves the cheapest class. On a tie joints at the ends of the arm precede joints between,
/// and the last one counts.
fn redundant(chain: &Chain, target: Target, length: &Number, given: Option<GivenBeside>) -> Result<InverseKinematics, String> {
    let joints = chain.joints.len();
    let with = |joint: usize| {
        // The turn about the end effector's z axis follows a given last joint. A slide along the last axis precedes it.
        let (rest, given) = if target == Target::Pointing {
            completed(chain.clone(), target)?.without(joint)
        } else {
            let (rest, given) = chain.without(joint);
            (completed(rest, target)?, given)
        };
        let mut found = classify(&rest, given.as_ref(), target, length)?;
        found.class += &format!("; q{} is given", joint + 1);
        // A joint between two others belongs to the loop.
        found.redundancy = given
            .or_else(|| found.loops().first().and_then(|way| way.given.clone()))
            .map(|given| Redundancy::Joint(Box::new(given)));
        Ok::<_, String>(found)
    };
    match given {
        Some(GivenBeside::Joint(joint)) => return with(joint.0 as usize),
        Some(GivenBeside::Swivel) => {
            let none = "there is no swivel angle: the first three and the last three of seven joints do not turn about axes through one point each";
            return classes::shoulder_elbow_wrist(chain, length).ok_or(none.into());
        }
        None => {}
    }
    if let Some(found) = classes::shoulder_elbow_wrist(chain, length) {
        return Ok(found);
    }
    let mut rest = Err(String::new());
    for joint in [joints - 1, 0].into_iter().chain((1..joints - 1).rev()) {
        let found = with(joint);
        if found.as_ref().is_ok_and(InverseKinematics::is_cheap) {
            return found;
        }
        rest = rest.or(found);
    }
    rest
}

impl InverseKinematics {
    /// The loops that the construction reads.
    pub fn loops(&self) -> &[Arrangement] {
        match &self.construction {
            Construction::SphericalTriple(way, _)
            | Construction::ThreeParallel(way, _)
            | Construction::ParallelTurns(way, _)
            | Construction::Position(way, _)
            | Construction::ThreePrismatic(way, _)
            | Construction::TwoSlides(way, _)
            | Construction::ShoulderElbowWrist(way) => std::slice::from_ref(way),
            Construction::General(ways) => ways.as_slice(),
        }
    }

    /// The names of the branches by number; empty where no solution has that branch.
    pub fn branches(&self) -> Vec<String> {
        let Some(last) = self.choices.last() else { return Vec::new() };
        let bits = |ways: usize| ways.next_power_of_two().trailing_zeros();
        let all = 1usize << (last.bit + bits(last.ways.len()));
        let name = |number: usize| {
            let mut left = number;
            let mut words = Vec::new();
            for choice in &self.choices {
                let mask = (choice.ways.len().next_power_of_two() - 1) << choice.bit;
                left &= !mask;
                words.push(choice.ways[(number & mask) >> choice.bit].as_str());
            }
            if left == 0 {
                words.join(", ")
            } else {
                String::new()
            }
        };
        (0..all).map(name).collect()
    }

    /// Whether no other class of its target is cheaper by much: neither a determinant nor a position that Newton's method finishes.
    fn is_cheap(&self) -> bool {
        match &self.construction {
            Construction::General(_) => false,
            Construction::Position(_, case) => case.closed,
            _ => true,
        }
    }

    /// The joint whose value is given, where one is.
    pub fn given(&self) -> Option<&Given> {
        match &self.redundancy {
            Some(Redundancy::Joint(given)) => Some(given),
            _ => None,
        }
    }
}

/// The target that the rows of the task make, and for how many joints it asks; one more is given.
fn target(manipulator: &Manipulator, chain: &Chain) -> Result<(Target, usize), String> {
    let rows = |rows: [TaskRow; 3]| rows.map(|row| manipulator.task.contains(&row));
    let mut linear = rows([TaskRow::X, TaskRow::Y, TaskRow::Z]);
    let mut angular = rows([TaskRow::Rx, TaskRow::Ry, TaskRow::Rz]);
    let wanted = manipulator.inverse_kinematics.target;
    match wanted {
        Some(Target::Pose) => (linear, angular) = ([true; 3], [true; 3]),
        Some(Target::Position) => angular = [false; 3],
        Some(Target::Planar) | None => {}
        Some(Target::Pointing) => {
            return match chain.joints.len() {
                5 | 6 => Ok((Target::Pointing, 5)),
                _ => Err("a pointing target asks for five joints, or for six, of which one is given".into()),
            }
        }
    }
    let count = |rows: [bool; 3]| rows.into_iter().filter(|row| *row).count();
    let axis = angular.iter().position(|row| *row);
    if wanted == Some(Target::Planar) && count(angular) != 1 {
        return Err("a planar target asks for a task with one angular row".into());
    }
    let (places, joints) = (count(linear), chain.joints.len());
    // Across which axis a plane is, of two rows.
    let across = || linear.iter().position(|row| !row);
    let target = match (places, count(angular), axis) {
        (3, 3, _) => return Ok((Target::Pose, 6)),
        (3, 0, _) => Target::Position,
        (2, 0, _) if across().is_some_and(|axis| chain.turns_about(axis)) => Target::Position,
        (2, 0, _) => {
            return Err("two rows of position are a target where all revolute axes are parallel to the axis of the third; \
                        `task: [x, y, z]` asks for the whole position"
                .into())
        }
        (2 | 3, 1, Some(axis)) if !chain.turns_about(axis) => {
            return Err(format!(
                "an angular row is a target beside rows of position where all revolute axes are parallel to its axis, here {} of the base; \
                 `task: [x, y, z]` asks for the position alone",
                ["x", "y", "z"][axis]
            ))
        }
        (3, 1, Some(_)) => Target::Planar,
        (2, 1, Some(axis)) if !linear[axis] => Target::Planar,
        _ => {
            return Err("the rows of the task make no target: that is a pose (all six rows), a position (two or three linear rows), these with \
                        the angular row of an axis to which all revolute axes are parallel, or, by `inverse_kinematics: {target: pointing}`, \
                        position and z axis of the end effector of five joints"
                .into())
        }
    };
    let wanted = places + count(angular);
    match joints.checked_sub(wanted) {
        Some(0 | 1) => Ok((target, wanted)),
        Some(more) => {
            let less = if more == 2 { "a joint".to_owned() } else { format!("{} joints", more - 1) };
            Err(format!(
                "{joints} joints are {more} more than the {wanted} rows of the task, and one more can be given; leave {less} out of \
                 the description that is used for this, first those that only turn the end effector"
            ))
        }
        None => {
            Err(format!("{joints} joints are fewer than the {wanted} rows of the task; leave rows out that they cannot meet"))
        }
    }
}

/// With the virtual joint for what a target leaves open: in a plane, a slide along the last axis; of a direction, a turn about it.
fn completed(mut chain: Chain, target: Target) -> Result<Chain, String> {
    let wanted = match target {
        Target::Pose => return Ok(chain),
        Target::Pointing => return chain.turn_at_the_end().map(|()| chain),
        Target::Planar => 4,
        Target::Position => 3,
    };
    if chain.joints.len() < wanted && chain.joints.last().is_some_and(|joint| !joint.prismatic) {
        chain.slide_at_the_end();
    }
    Ok(chain)
}

/// The class of an arm with its virtual joints. A joint at an end may be `taken`: its value is given. For a position the other
/// joints must move the end effector in three directions. In a direction that they cannot move, a target has no posture, or a
/// continuum at a single value.
fn classify(chain: &Chain, taken: Option<&Given>, target: Target, length: &Number) -> Result<InverseKinematics, String> {
    let jacobian = if target == Target::Position { Jacobian::of(chain, taken) } else { None };
    let Some(jacobian) = jacobian.filter(|jacobian| jacobian.rank(3) < chain.joints.len()) else {
        return classes::classify(chain, target, length);
    };
    let rows = ["x", "y", "z"];
    let (still, rest): (Vec<_>, Vec<_>) = (0..3).partition(|axis| jacobian.is_still(*axis));
    Err(match (still.as_slice(), chain.left_out) {
        ([axis], None) => {
            let (row, rest) = (rows[*axis], rest.into_iter().map(|axis| rows[axis]).collect::<Vec<_>>().join(", "));
            format!("no joint moves the end effector along {row} of the base, a row of the task; `task: [{rest}]` leaves it out")
        }
        (_, None) => "at every posture the joints move the end effector in fewer directions than the task has rows; \
                      leave rows out that they cannot meet"
            .into(),
        (_, Some(joint)) => format!(
            "with q{} given the joints move the end effector in fewer directions than the task has rows, at every posture; \
             another joint can be given, or rows left out",
            joint + 1
        ),
    })
}

/// The largest length of an arm; 1 m where all are 0.
fn size(chain: &Chain) -> Number {
    let mut largest = Number::zero();
    for length in chain.lengths() {
        let length = if length.is_negative() { -&length } else { length };
        if (&largest - &length).is_negative() {
            largest = length;
        }
    }
    if largest.is_zero() {
        Number::one()
    } else {
        largest
    }
}

/// Whether a joint of the description slides.
fn is_prismatic(kind: JointKind) -> bool {
    kind == JointKind::Prismatic
}
