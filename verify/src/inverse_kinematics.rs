//! Certificates for emitted inverse kinematics: whether a module `robot_ik.rs` finds all solutions.
//!
//! 1. *Text*: every building block equals the tested one byte for byte, every number is the float nearest to its exact value, and the function
//!    calls a construction. Everything else, comments and names of branches included, equals the output of armgen for the description.
//!    With the exact values the loop closes, J1 L1 ... Jn Ln = 1, at random points of prime fields, and meets the construction's conditions.
//! 2. *Soundness*: the blocks of closed forms, as texts, run in prime fields: every branch closes the loop exactly (`soundness`).
//! 3. *Generic completeness*: at random poses in prime fields the equations have as many solutions as the construction has branches.
//! 4. *Counts*: at rational poses Sturm's theorem gives the number of real solutions. The unmodified module, run in double precision, returns
//!    the same number.
//!
//! A C module is a translation of the Rust module, which is verified instead; its text must equal armgen's translation.
//!
//! This check does not classify arms: the exact values are claims of the generator, and the conditions of a construction are tested on them.
//! It counts solutions with separate equations, arrangements and algebra (`forms`, `quotient`), which do not depend on classes.

mod certificate;
mod chain;
mod class;
mod coordinates;
mod counts;
mod forms;
mod modular;
mod points;
mod polynomials;
mod quotient;
mod run;
mod soundness;
mod sturm;
mod text;

use std::fmt;

use armgen_description::exact::Number;
use armgen_description::kinds::{JointKind, Scalar};
use armgen_description::manipulator::Manipulator;
use armgen_description::source::Source;
use sha2::{Digest, Sha256};

use crate::judge::stated;
use crate::read::reader::{is_hidden, name_of};
use crate::textbook::equations::arm::{formula, Arm};
use crate::textbook::equations::pose::Pose;
use crate::textbook::equations::state::State;
use crate::values::check::Check;
use crate::values::element::Element;
use crate::values::enclosure::Float;
use crate::values::float::Arguments;
use crate::values::formula::Formula;
use crate::values::stream::Stream;
use chain::Chain;
use counts::{Count, Counter, RationalPose, Way};
use points::{posture, Constants, Loop};
use run::Verdict;
use text::{Construction, Text};

/// Whether a text is a module of inverse kinematics.
pub fn is_one(text: &str) -> bool {
    text.contains("\nmod all_solutions {\n") || text.contains("\n// There is no `inverse_kinematics`: ") || is_c(text)
}

/// Whether it is a C module.
pub fn is_c(text: &str) -> bool {
    text.starts_with("/*") && (text.contains("_nearest_to(") || text.contains("\n * There is no inverse kinematics: "))
}

/// The named end effector that a text is of, by its number; `None` of an arm that has one end effector without a name.
///
/// # Errors
/// An end effector that the arm does not have, or none where it has several.
pub fn end_effector(manipulator: &Manipulator, text: &str) -> Result<Option<usize>, String> {
    let head = text.lines().take_while(|line| line.is_empty() || line.starts_with(['/', ' '])).find_map(|line| {
        let line = line.strip_prefix("// ").or_else(|| line.strip_prefix(" * "))?;
        Some(line.strip_prefix("End effector: ")?.split_once(". Entries of q: ")?.0)
    });
    match head {
        None if manipulator.tips.is_empty() => Ok(None),
        None => Err("the module does not name the end effector that it is of".into()),
        Some(name) => {
            let tip = manipulator.tips.iter().position(|tip| tip.name == name);
            tip.map(Some).ok_or_else(|| format!("the arm has no end effector `{name}`"))
        }
    }
}

/// Number of rational poses for counts.
pub const POSES: usize = 64;

/// The generator's proposal, in the language and the scalar of the module under verification.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// Exact values, which need no trust, or the reason why the arm has no construction.
    pub values: Result<Values, String>,
    /// The module in Rust.
    pub rust: String,
    /// The C module, if a C module is verified; an error is a fault of the generator.
    pub c: Option<Result<String, String>>,
}

/// Exact values of a construction's numbers, in the order of its text.
#[derive(Clone, Debug)]
pub struct Values {
    /// Numbers of each loop.
    pub loops: Vec<Vec<Number>>,
    /// Numbers of the arm's own loop, if it has fewer joints than the pose has rows.
    pub own: Option<Vec<Number>>,
    /// Numbers of the link that the given joint moves.
    pub given: Vec<Number>,
    /// A length of the arm's size, m.
    pub length: Number,
    /// Of coupled joints, the coordinates over joint variables: factors by rows, and constants.
    pub coordinates: Option<(Vec<Vec<Number>>, Vec<Number>)>,
}

/// The findings about a module of inverse kinematics.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Name of the robot.
    pub robot: String,
    /// `f64` or `f32`.
    pub scalar: &'static str,
    /// SHA-256 of the description, hexadecimal.
    pub input: String,
    /// SHA-256 of the module, hexadecimal.
    pub output: String,
    /// The exact values of the loop's numbers, in the order of the text.
    pub exact_values: Vec<String>,
    /// Whether the module states that the arm has no construction.
    pub absent: bool,
    /// Whether the module is in C: the findings concern the Rust module, and the C module is its translation, line by line.
    pub translated: bool,
    /// Maximum number of solutions, according to the module.
    pub most: usize,
    /// Number of constants that are the floats nearest to their exact values.
    pub numbers: usize,
    /// Number of branches that close the loop at random poses of prime fields, for a construction of closed forms.
    pub sound: Option<usize>,
    /// Number of solutions at random poses, including complex ones; and the order of the joints in the loop that counted them, from 1.
    pub generic: Option<(usize, Vec<usize>)>,
    /// Number of rational poses where the module returns all solutions.
    pub equal: usize,
    /// Number of these poses without a solution.
    pub unreachable: usize,
    /// Number of rational poses where the module reports uncertainty.
    pub near: usize,
    /// Number of these poses with coincident solutions.
    pub singular: usize,
    /// Number of rational poses with infinitely many solutions or an undetermined count.
    pub undecided: usize,
    /// The reason why nothing was counted, if so.
    pub uncounted: Option<String>,
    /// The faults.
    pub faults: Vec<String>,
}

impl Report {
    /// Whether there are no faults.
    pub fn passed(&self) -> bool {
        self.faults.is_empty()
    }

    /// A one-line summary of a report that passed.
    pub fn summary(&self) -> String {
        let poses = self.equal + self.near + self.undecided;
        match (&self.generic, &self.uncounted) {
            _ if self.absent => "there is no construction for inverse kinematics".into(),
            (Some((solutions, _)), None) => {
                format!(
                    "inverse kinematics: {solutions} solutions at random poses, counts of {} of {poses} rational poses proved",
                    self.equal
                )
            }
            (Some((solutions, _)), Some(reason)) => {
                format!("inverse kinematics: {solutions} solutions at random poses; not counted at rational poses: {reason}")
            }
            (None, reason) => format!("inverse kinematics: solutions are not counted: {}", reason.as_deref().unwrap_or("")),
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "robot {}, inverse kinematics, {}", self.robot, self.scalar)?;
        if self.absent {
            return write!(f, "the module says that there is no construction: nothing to verify");
        }
        if self.translated {
            writeln!(f, "in C, line by line what armgen translates from the module in Rust, of which this is found:")?;
        }
        if self.numbers > 0 {
            writeln!(f, "building blocks are the tested ones, {} numbers equal the description, the loop closes", self.numbers)?;
        }
        if let Some(sound) = self.sound {
            writeln!(f, "{sound} branches are sound: run in prime fields they close the loop exactly")?;
        }
        if let Some((solutions, order)) = &self.generic {
            let order: Vec<String> = order.iter().map(ToString::to_string).collect();
            writeln!(
                f,
                "{solutions} solutions at random poses, counted with the loop read as {}; the module has room for {}",
                order.join(" "),
                self.most
            )?;
        }
        match &self.uncounted {
            Some(reason) => writeln!(f, "not counted at rational poses: {reason}")?,
            None if self.equal + self.near > 0 => writeln!(
                f,
                "{} rational poses counted by Sturm's theorem: {} equal, {} of them without a solution; {} said to be near a double solution, {} of them rightly; {} more not counted, where a joint can be free",
                self.equal + self.near,
                self.equal,
                self.unreachable,
                self.near,
                self.singular,
                self.undecided
            )?,
            None => {}
        }
        match self.faults.first() {
            None => write!(f, "verified"),
            Some(fault) => write!(f, "not verified: {fault}"),
        }
    }
}

/// Verifies a module of inverse kinematics against its description, and counts solutions at this number of rational poses.
pub fn verify(source: &Source, text: &str, proposal: &Proposal, poses: usize) -> Report {
    let hash = crate::hash;
    let mut report = Report { input: hash(source.text()), output: hash(text), ..Report::default() };
    let manipulator = match crate::arm(source) {
        Ok(manipulator) => manipulator,
        Err(faults) => return Report { faults: vec![faults], ..report },
    };
    let manipulator = match end_effector(&manipulator, text) {
        Ok(Some(tip)) => manipulator.arm_to(tip),
        Ok(None) => manipulator,
        Err(fault) => return Report { faults: vec![fault], ..report },
    };
    report.robot.clone_from(&manipulator.name);
    if let Some((line, c)) = hidden(text) {
        report.faults.push(format!("line {line}: the character {}, which cannot be seen", name_of(c)));
        return report;
    }
    // A C module is checked through the Rust module of which it must be a translation.
    report.translated = is_c(text);
    let in_rust = if report.translated { proposal.rust.as_str() } else { text };
    if let Err(fault) = fill(&mut report, &manipulator, &proposal.values, source, in_rust, poses) {
        report.faults.push(fault);
    }
    if report.faults.is_empty() && Check::WholeText.is_made() {
        report.faults.extend(difference(proposal, source, text));
    }
    report
}

/// The first invisible character, with its line.
fn hidden(text: &str) -> Option<(usize, char)> {
    text.split('\n').zip(1..).find_map(|(line, number)| Some((number, line.chars().find(|c| is_hidden(*c))?)))
}

/// The first line that differs from armgen's output for the description. This covers everything that the other checks do not judge by its
/// effect, such as comments and branch names. The file name in the first line may differ.
fn difference(proposal: &Proposal, source: &Source, text: &str) -> Option<String> {
    let (comment, wanted) = match &proposal.c {
        Some(c) if is_c(text) => ("/* ", c.as_ref()),
        _ => ("// ", Ok(&proposal.rust)),
    };
    let wanted = match wanted {
        Ok(wanted) => wanted,
        Err(reason) => return Some(reason.clone()),
    };
    let (first, rest) = text.split_once('\n').unwrap_or((text, ""));
    if let Err(fault) = stated::origin(first.strip_prefix(comment).unwrap_or(""), &crate::hash(source.text())) {
        return Some(format!("line 1: {fault}"));
    }
    let (number, found, wanted) = stated::first_difference(rest.split('\n'), wanted.split('\n').skip(1))?;
    Some(format!("line {}: {found} where armgen writes {wanted}", number + 2))
}

/// The scalar according to the module.
pub fn scalar_of(text: &str) -> Scalar {
    let single = ["pub type Real = f32;", "\ntypedef float "].iter().any(|line| text.contains(line));
    if single {
        Scalar::F32
    } else {
        Scalar::F64
    }
}

fn fill(
    report: &mut Report,
    manipulator: &Manipulator,
    values: &Result<Values, String>,
    source: &Source,
    text: &str,
    poses: usize,
) -> Result<(), String> {
    let Some(module) = Text::read(text)? else {
        report.absent = true;
        return Ok(());
    };
    let (whole, manipulator) = (manipulator, &points::without_bodies(manipulator));
    report.scalar = module.real.name();
    report.most = module.most;
    // The seed omits the first line: it contains a freely chosen file name, which could otherwise select the poses.
    let (_, chosen) = text.split_once('\n').unwrap_or_default();
    let seed: [u8; 32] = Sha256::new().chain_update(source.text()).chain_update([0]).chain_update(chosen).finalize().into();
    let mut stream = Stream::of(seed);
    let claims = claims(values)?;
    report.numbers = numbers(&module, whole, &claims)?;
    let of_coordinates = coordinates::check(&module, whole, &claims.coordinates)?;
    report.numbers += of_coordinates.len();
    let all: Vec<Formula> = claims.loops.iter().chain(&claims.own).flatten().chain(&claims.given).cloned().collect();
    report.exact_values = all.iter().chain(&of_coordinates).map(ToString::to_string).collect();
    let constants = Constants::of(manipulator, &all)?;
    let most = construction(&module, manipulator, &constants, &claims, &mut stream)?;
    if module.most != most && Check::MostSolutions.is_made() {
        return Err(format!("MAX_SOLUTIONS: {} where the construction has {most}", module.most));
    }
    let sound = sound(&module, manipulator, &constants, &claims, &mut stream)?;
    report.sound = sound.map(|(branches, _)| branches);
    if module.construction == Construction::ShoulderElbowWrist {
        report.uncounted = Some("the swivel angle is given".into());
        return Ok(());
    }
    // Arrangements that the module does not use.
    let given = module.given.as_ref().map(|given| given.joint);
    let pointing = chain::is_pointing(manipulator);
    let joints = module.dof - usize::from(given.is_some()) + usize::from(pointing);
    let point = !module.rotation;
    let mut ways = Way::all(joints, point);
    if module.construction == Construction::General {
        ways.retain(|way| !module.loops.iter().any(|used| used.order == way.order(joints)));
    }
    let generic = match counts::generic(manipulator, &constants, (&ways, given), &mut stream) {
        Ok(generic) => generic,
        Err(reason) => {
            report.uncounted = Some(reason);
            return Ok(());
        }
    };
    report.generic = Some((
        generic.solutions,
        generic
            .way
            .order(joints)
            .iter()
            .map(|joint| joint + 1 + usize::from(given.is_some_and(|given| *joint >= given)))
            .collect(),
    ));
    let branches =
        if module.branches.is_empty() { module.most } else { module.branches.iter().filter(|b| !b.is_empty()).count() };
    // For an arm with virtual joints, only branches with these joints at 0 count.
    let lost = match (&module.own, sound) {
        (None, _) if !module.branches.is_empty() => generic.solutions != branches,
        (Some(_), Some((_, own))) => {
            if own != generic.solutions && Check::Branches.is_made() {
                return Err(format!(
                    "BRANCHES: {own} of them have the virtual joints at 0, and there are {} solutions at a random pose",
                    generic.solutions
                ));
            }
            false
        }
        _ => generic.solutions > module.most,
    };
    if lost && Check::Branches.is_made() {
        return Err(format!("BRANCHES: {branches} of them, and there are {} solutions at a random pose", generic.solutions));
    }
    if !constants.are_fractions() {
        report.uncounted = Some("constants of the arm are no fractions".into());
        return Ok(());
    }
    if module.real != Float::F64 {
        report.uncounted = Some("the module is in single precision".into());
        return Ok(());
    }
    let length = module.length.parse().unwrap_or(1.0);
    let poses = RationalPose::some(module.dof, poses, (length, module.own.is_some()), &mut stream);
    let arm = constants.arm.map(&|number| Float::F64.nearest(number).unwrap_or(0.0));
    let mut counter = Counter::new(manipulator, &constants, generic, stream);
    for (number, pose) in poses.iter().enumerate() {
        let count = counter.at(pose)?;
        let exact = pose.exact(&constants);
        let rounded = exact.each_ref().map(|row| row.each_ref().map(|entry| Float::F64.nearest(entry).unwrap_or(0.0)));
        let redundancy = given.map_or(0.0, |joint| {
            let (n, d) = pose.values[joint];
            let x = n as f64 / d as f64;
            if manipulator.joints[joint].kind == JointKind::Prismatic {
                x
            } else {
                2.0 * libm::atan(x)
            }
        });
        let outcome = run::run(&module, &rounded, redundancy).ok_or("the function cannot be run")?;
        let first = match module.rotation {
            true if pointing => 2,
            true => 0,
            false => 3,
        };
        judge(report, count, &outcome, &misses(&arm, &outcome, &rounded, first, manipulator))
            .map_err(|fault| format!("inverse_kinematics: at rational pose {} {fault}", number + 1))?;
    }
    Ok(())
}

/// Exact values of the loops' numbers, in order. The generator proposes them; they need no trust.
struct Claims {
    loops: Vec<Vec<Formula>>,
    own: Option<Vec<Formula>>,
    given: Vec<Formula>,
    length: Formula,
    coordinates: Option<(Vec<Vec<Number>>, Vec<Number>)>,
}

fn claims(values: &Result<Values, String>) -> Result<Claims, String> {
    let values = values.as_ref().map_err(|reason| format!("the arm has no construction: {reason}"))?;
    let formulas = |numbers: &Vec<Number>| numbers.iter().map(formula).collect();
    Ok(Claims {
        loops: values.loops.iter().map(formulas).collect(),
        own: values.own.as_ref().map(formulas),
        given: formulas(&values.given),
        length: formula(&values.length),
        coordinates: values.coordinates.clone(),
    })
}

/// Whether a number of the text is the float nearest to an exact value.
fn is_nearest(module: &Text, text: &str, exact: &Formula) -> bool {
    module.real.read(text.trim_start_matches('-')).is_some_and(|value| {
        let value = if text.starts_with('-') { -value } else { value };
        module.real.is_nearest(value, exact)
    })
}

/// Checks that all numbers are the floats nearest to the claimed values or to those of the description; returns their count.
fn numbers(module: &Text, manipulator: &Manipulator, claims: &Claims) -> Result<usize, String> {
    let nearest = |text: &str, exact: &Formula| is_nearest(module, text, exact);
    let mut count = 1;
    if module.dof != manipulator.dof() {
        return Err(format!("DOF: {} where the arm has {} joints", module.dof, manipulator.dof()));
    }
    for (i, coordinate) in manipulator.coordinates().into_iter().enumerate() {
        if module.prismatic[i] != (coordinate.joint.kind == JointKind::Prismatic) {
            return Err(format!("PRISMATIC: joint {} is of the other kind", i + 1));
        }
        for (side, infinite) in ["Real::NEG_INFINITY", "Real::INFINITY"].into_iter().enumerate() {
            let text = module.limits[2 * i + side].as_str();
            let right = match &coordinate.limits.position {
                None => text == infinite,
                Some(limits) => nearest(text, &formula(&limits[side])),
            };
            if !right && Check::Limits.is_made() {
                return Err(format!("POSITION_LIMITS: {text} is not what the description says of joint {}", i + 1));
            }
            count += 1;
        }
    }
    if !nearest(&module.length, &claims.length) && Check::LoopNumbers.is_made() {
        return Err(format!("LENGTH: {} is not the float nearest to {}", module.length, claims.length));
    }
    if module.own.is_some() != claims.own.is_some() {
        return Err("ARM: the arm has it if it has fewer joints than the pose has rows".into());
    }
    let loops = module.loops.iter().map(|way| &way.numbers).zip(&claims.loops);
    let loops = loops.chain(module.own.iter().map(|way| &way.numbers).zip(&claims.own));
    for (texts, claimed) in loops.chain(module.given.iter().map(|given| (&given.numbers, &claims.given))) {
        if texts.len() != claimed.len() {
            return Err("LOOP: the loop has another number of joints than the arm".into());
        }
        for (text, exact) in texts.iter().zip(claimed) {
            if !nearest(text, exact) && Check::LoopNumbers.is_made() {
                return Err(format!("LOOP: {text} is not the float nearest to {exact}"));
            }
            count += 1;
        }
    }
    Ok(count)
}

/// The maximum number of solutions of the construction. At random points, the loop must close and meet the construction's conditions.
fn construction(
    module: &Text,
    manipulator: &Manipulator,
    constants: &Constants,
    claims: &Claims,
    stream: &mut Stream,
) -> Result<usize, String> {
    let mut most = 0;
    for _ in 0..2 {
        let mut field = constants.field(stream)?;
        let chain = Chain::of(manipulator, &field).ok_or("a constant of the description divides by zero")?;
        let mut posture = posture(&chain, &mut field);
        let mut pose = chain.pose(&posture);
        let mut kinds = chain.slides.clone();
        let mut moved = None;
        if let Some(given) = &module.given {
            let value = posture.remove(given.joint);
            if kinds.remove(given.joint) != given.prismatic {
                return Err("GIVEN: the joint is of the other kind".into());
            }
            let link = points::link(given, &claims.given, &field, value).ok_or("a constant of the loop divides by zero")?;
            moved = Some(link);
            if given.place.is_none() {
                pose = points::rest(given, &link, chain.modulus, &pose);
            }
        }
        if let (Some(way), Some(numbers)) = (&module.own, &claims.own) {
            let own = Loop::of(way, numbers, &field).ok_or("a constant of the loop divides by zero")?;
            if !own.closes(way, &kinds, &posture, &pose) && Check::Loop.is_made() {
                return Err("ARM: it is not the loop of this arm".into());
            }
        }
        for (way, numbers) in module.loops.iter().zip(&claims.loops) {
            let mut closed = Loop::of(way, numbers, &field).ok_or("a constant of the loop divides by zero")?;
            if let (Some(place), Some(link)) = (way.moved, moved) {
                closed.links[place] = link;
            }
            if !closed.closes(way, &kinds, &posture, &pose) && Check::Loop.is_made() {
                return Err("LOOP: it is not the loop of this arm".into());
            }
            closed.links = closed.links_at(way, &pose);
            if module.own.is_some() && Check::Class.is_made() {
                let values = closed.values(way, &kinds, &posture).unwrap_or_default();
                if !closed.is_regular(&way.prismatic, &closed.links, &values) {
                    return Err("the class is wrong: with its virtual joints the arm is singular wherever they are 0".into());
                }
            }
            match class::most(&module.construction, way, &closed, module.own.is_some()) {
                Ok(found) => most = found,
                Err(fault) if Check::Class.is_made() => return Err(fault),
                Err(_) => most = module.most,
            }
        }
    }
    Ok(most)
}

/// Maximum number of random poses for branches with square roots.
const MOST_POSES: usize = 1 << 15;

/// The number of branches of a closed-form construction that close the loop; and the most of them at a pose with all virtual joints at 0.
fn sound(
    module: &Text,
    manipulator: &Manipulator,
    constants: &Constants,
    claims: &Claims,
    stream: &mut Stream,
) -> Result<Option<(usize, usize)>, String> {
    if !soundness::is_closed(&module.construction) {
        return Ok(None);
    }
    let named: Vec<bool> = module.branches.iter().map(|name| !name.is_empty()).collect();
    let mut sound = vec![false; named.len()];
    let open = |sound: &[bool]| named.iter().zip(sound).any(|(named, sound)| *named && !sound);
    let (mut tried, mut own) = (0, 0);
    while tried < MOST_POSES && open(&sound) {
        let mut field = constants.field(stream)?;
        let chain = Chain::of(manipulator, &field).ok_or("a constant of the description divides by zero")?;
        let closed = Loop::of(&module.loops[0], &claims.loops[0], &field).ok_or("a constant of the loop divides by zero")?;
        for _ in 0..64 {
            tried += 1;
            let whole = posture(&chain, &mut field);
            let mut pose = chain.pose(&whole);
            let mut closed = closed.clone();
            let mut tip = [0; 3];
            if let Some(given) = &module.given {
                let value = whole[given.joint];
                let link = points::link(given, &claims.given, &field, value).ok_or("a constant of the loop divides by zero")?;
                match given.place {
                    None if !module.rotation && given.joint > 0 => tip = link.map(|row| row[3]),
                    None => pose = points::rest(given, &link, chain.modulus, &pose),
                    Some(place) => closed.links[place] = link,
                }
            }
            let at = soundness::At { closed: &closed, pose: &pose, tip, posture: &whole };
            let branch = soundness::run(module, &at, &mut sound);
            match branch {
                Ok(number) => own = own.max(number),
                Err(branch) if Check::Sound.is_made() => {
                    return Err(format!("BRANCHES: branch {branch} does not close the loop"))
                }
                Err(_) => {}
            }
        }
    }
    let lost = named.iter().zip(&sound).position(|(named, sound)| *named && !sound);
    if let (Some(branch), true) = (lost, Check::Sound.is_made()) {
        return Err(format!("BRANCHES: branch {branch} does not close the loop at any of {tried} random poses"));
    }
    Ok(Some((sound.into_iter().filter(|sound| *sound).count(), own)))
}

/// The distance of each solution from the pose, in the columns from `first` on, which the target fixes.
fn misses(arm: &Arm<f64>, outcome: &run::Outcome, pose: &[[f64; 4]; 3], first: usize, manipulator: &Manipulator) -> Vec<f64> {
    use armgen_description::kinds::TaskRow;
    let rows = [TaskRow::X, TaskRow::Y, TaskRow::Z].map(|row| manipulator.task.contains(&row));
    let miss = |joints: &Vec<[f64; 2]>| {
        let zeros = vec![0.0; joints.len()];
        let arguments = Arguments {
            pi: Vec::new(),
            q: joints.iter().map(|value| value[0]).collect(),
            dq: zeros.clone(),
            ddq: zeros.clone(),
            dqr: zeros.clone(),
            ddqr: zeros.clone(),
            tau: zeros.clone(),
            g0: Vec::new(),
        };
        let angles = joints.iter().map(|[c, s]| (*s, *c)).collect();
        let tool = Pose::new(arm, &State::of(arguments, angles, zeros, [0.0, 1.0])).tools.swap_remove(0);
        let mut most = 0.0f64;
        for i in 0..3 {
            for j in 0..4 {
                let (found, counts) = if j == 3 { (tool.origin[i], rows[i]) } else { (tool.rotation[i][j], j >= first) };
                if counts {
                    most = most.max(found.minus(&pose[i][j]).abs());
                }
            }
        }
        most
    };
    outcome.solutions.iter().map(miss).collect()
}

/// Maximum error of a solution for poses with lengths of some metres, m or rad.
const RIGHT: f64 = 1e-8;

/// Whether the module's result for a pose agrees with the proved count.
fn judge(report: &mut Report, count: Count, outcome: &run::Outcome, misses: &[f64]) -> Result<(), String> {
    let found = outcome.solutions.len();
    let certain = matches!(outcome.verdict, Verdict::Complete | Verdict::Unreachable);
    if certain && misses.iter().any(|miss| *miss > RIGHT) && Check::Reached.is_made() {
        return Err("a solution does not reach it".into());
    }
    let Count::Finite(roots) = count else {
        report.undecided += 1;
        return Ok(());
    };
    if roots.multiple > 0 {
        if certain && Check::Meeting.is_made() {
            return Err(format!("solutions meet, and the module says {:?}", outcome.verdict));
        }
        report.near += 1;
        report.singular += 1;
        return Ok(());
    }
    if !certain {
        report.near += 1;
        return Ok(());
    }
    if found != roots.real && Check::Counts.is_made() {
        return Err(format!("there are {} solutions, and the module returns {found}", roots.real));
    }
    report.equal += 1;
    report.unreachable += usize::from(found == 0);
    Ok(())
}

#[cfg(test)]
pub(crate) mod tests;
