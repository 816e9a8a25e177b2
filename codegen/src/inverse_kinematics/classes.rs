//! Which class an arm is of: the cheapest whose exact tests it passes; of equals the lowest start of the loop, forwards before backwards.

use super::chain::{Arrangement, Chain, Given};
use super::frame::{compose, is_parallel, is_right, is_zero, slide_along_z, sum_of_angles, turn_about_z, turns_beside_x, Frame};
use super::general;
use super::{Choice, Construction, InverseKinematics, Redundancy, Target};
use crate::exact::{Number, Rational};

/// A case of block 6: three joints that bring a point to a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Regional {
    /// The function.
    pub function: &'static str,
    /// The text that has it.
    pub text: &'static str,
    /// Closed forms throughout; others are polished.
    pub closed: bool,
    /// The largest number of solutions.
    pub most: usize,
    /// The alternatives of its signs, from bit 0 on; empty for the four roots of an equation.
    choices: &'static [(Pair, Sign)],
    /// What makes it hold, with `{1}`, `{2}`, `{3}` for the joints.
    because: &'static str,
}

/// The names of two ways.
type Pair = [&'static str; 2];

const SHOULDER: Pair = ["shoulder left", "shoulder right"];
const ELBOW: Pair = ["elbow up", "elbow down"];
const WRIST: Pair = ["wrist not flipped", "wrist flipped"];
const TURN: Pair = ["turn left", "turn right"];
const SLIDE: Pair = ["slide far", "slide near"];

/// The quantity that is positive in the first of two ways, and negative in the second; joints by their places in the case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sign {
    /// a sin q - b cos q for the joint's equation a cos q + b sin q = d: the root w of block 1.
    Root(usize),
    /// The sine of the angle from the first link to the second: block 4.
    Links,
    /// The root of the equation for the joint's length.
    Length(usize),
}

impl Sign {
    fn meaning(self, joints: &[usize]) -> String {
        let joint = |place: usize| joints.get(place - 1).copied().unwrap_or_default();
        match self {
            Sign::Root(place) => {
                let q = joint(place);
                format!("the sign of a sin q{q} - b cos q{q} in the equation a cos q{q} + b sin q{q} = d of the block that gives q{q}")
            }
            Sign::Links => {
                "the sign of the sine of the angle from the first link to the second, about the first of the two axes".into()
            }
            Sign::Length(place) => format!("the sign of the root in the quadratic equation for q{}", joint(place)),
        }
    }
}

/// A choice between two ways.
fn two(bit: u32, ways: Pair, meaning: String) -> Choice {
    Choice { bit, ways: ways.map(String::from).to_vec(), meaning }
}

/// A choice between the four roots of an equation on a circle.
fn four(joint: usize) -> Choice {
    let ways = (1..=4).map(|root| format!("root {root} of q{joint}")).collect();
    Choice { bit: 0, ways, meaning: format!("the number of the root of the equation for q{joint}, anticlockwise from 0") }
}

/// The two ways of the wrist.
fn wrist(bit: u32, joint: usize) -> Choice {
    two(bit, WRIST, format!("the sign of sin q{joint}"))
}

const TURNING: &str = "regional";
const ONE_SLIDE: &str = "regional_one_prismatic";
const SLIDES: &str = "regional_prismatic";

/// Axes 1 and 2 intersect.
const CROSSING: Regional = Regional {
    function: "regional_crossing",
    text: TURNING,
    closed: true,
    most: 4,
    choices: &[(ELBOW, Sign::Root(3)), (SHOULDER, Sign::Root(2))],
    because: "axes {1} and {2} intersect",
};

/// The case of block 6 for the first three joints of a loop: with a joint that is given between them, that of some of its values.
fn regional_of(way: &Arrangement) -> Option<Regional> {
    let constant = [0, 1].map(|place| way.is_constant(place));
    let cases = [0, 1, 2].map(|sample| regional(way.kinds(), &way.link(0, sample), &way.link(1, sample), constant, way.open < 2));
    cases[0].filter(|_| cases.iter().all(|case| *case == cases[0]))
}

/// The case of block 6 for three joints of given kinds with links A, B, as far as they are `constant`; `posed`: the pose is in one of them, and that
/// one is not looked at.
fn regional(kinds: [bool; 3], a: &Frame, b: &Frame, constant: [bool; 2], posed: bool) -> Option<Regional> {
    let case = |function, text, closed, most, choices, because| Some(Regional { function, text, closed, most, choices, because });
    let meet = |f: &Frame| is_zero(&f[0][3]);
    let crossing = constant[0] && meet(a) && !is_parallel(a);
    if posed {
        let degenerate = constant[0] && is_parallel(a);
        return match kinds {
            [false, false, false] if crossing => Some(CROSSING),
            [false, false, false] if !degenerate => {
                case("regional_general", TURNING, false, 4, &[], "no two axes of {1} {2} {3} related for every pose")
            }
            _ => None,
        };
    }
    match kinds {
        [false, false, false] if constant[1] && is_parallel(b) && !meet(b) && !is_parallel(a) => case(
            "regional_elbow",
            TURNING,
            true,
            4,
            &[(SHOULDER, Sign::Root(1)), (ELBOW, Sign::Links)],
            "axes {2} and {3} are parallel",
        ),
        [false, false, false] if crossing && !(is_parallel(b) && meet(b)) => Some(CROSSING),
        [false, false, false] if !is_parallel(a) && !meet(a) && !(constant[1] && (is_parallel(b) || meet(b))) => {
            let because = match constant[1] {
                true => "axes {1}, {2} and {3} neither are parallel nor intersect",
                false => "axes {1} and {2} neither are parallel nor intersect",
            };
            case("regional_general", TURNING, false, 4, &[], because)
        }
        [true, false, false] if constant[1] && is_parallel(b) && !meet(b) && !is_right(a) => case(
            "regional_slide_elbow",
            ONE_SLIDE,
            true,
            2,
            &[(ELBOW, Sign::Links)],
            "joint {1} slides, axes {2} and {3} are parallel",
        ),
        [true, false, false] if is_right(a) && !(is_parallel(b) && meet(b)) => case(
            "regional_slide_across",
            ONE_SLIDE,
            true,
            4,
            &[(ELBOW, Sign::Root(3)), (SHOULDER, Sign::Root(2))],
            "joint {1} slides at right angles to axis {2}",
        ),
        [true, false, false] if !is_parallel(b) && !is_right(a) => {
            case("regional_slide", ONE_SLIDE, false, 4, &[], "joint {1} slides")
        }
        [false, true, false] if is_parallel(&compose(a, b)) && !is_right(a) => case(
            "regional_mid_slide_elbow",
            ONE_SLIDE,
            true,
            2,
            &[(ELBOW, Sign::Links)],
            "joint {2} slides, axes {1} and {3} are parallel",
        ),
        [false, true, false] if is_right(a) => case(
            "regional_mid_slide_across",
            ONE_SLIDE,
            true,
            4,
            &[(ELBOW, Sign::Root(3)), (SLIDE, Sign::Length(2))],
            "joint {2} slides at right angles to axis {1}",
        ),
        [false, true, false] => case("regional_mid_slide", ONE_SLIDE, false, 4, &[], "joint {2} slides"),
        [true, true, false] if !is_parallel(a) => {
            case("regional_plane_then_turn", SLIDES, true, 2, &[(TURN, Sign::Root(3))], "joints {1} and {2} slide")
        }
        [true, false, true] if !(is_parallel(a) && is_parallel(b)) => {
            case("regional_slide_turn_slide", SLIDES, true, 2, &[(TURN, Sign::Root(2))], "joints {1} and {3} slide")
        }
        [true, true, true] if spans_space(a, b) => case("regional_slides", SLIDES, true, 1, &[], "joints {1}, {2} and {3} slide"),
        _ => None,
    }
}

/// Whether the directions of three slides, e3, A e3 and A B e3, span space.
fn spans_space(a: &Frame, b: &Frame) -> bool {
    let chain = compose(a, b);
    let determinant = &(&a[0][2] * &chain[1][2]) - &(&a[1][2] * &chain[0][2]);
    !is_zero(&determinant)
}

impl Regional {
    /// Its choices as bits of the branch.
    fn choices(&self, joints: &[usize]) -> Vec<Choice> {
        if self.most == 4 && self.choices.is_empty() {
            return vec![four(joints[2])];
        }
        let choice = |(bit, (ways, sign)): (usize, &(Pair, Sign))| two(bit as u32, *ways, sign.meaning(joints));
        self.choices.iter().enumerate().map(choice).collect()
    }

    fn because(&self, joints: &[usize]) -> String {
        let mut text = self.because.to_owned();
        for (i, joint) in joints.iter().take(3).enumerate() {
            text = text.replace(&format!("{{{}}}", i + 1), &joint.to_string());
        }
        text
    }
}

impl Given {
    /// The link that it moves, at one of three values. An entry has degree 1 in the value, or in its sine and cosine, and so at
    /// most two zeros on the circle: an entry that is 0 at three values is 0 at all values.
    pub(super) fn link(&self, sample: usize) -> Frame {
        let (x, y, over) = [(33, 56, 65), (48, 55, 73), (-13, 84, 85)][sample];
        let over = Number::from(Rational::ONE / Rational::from(over));
        let [c, s] = [x, y].map(|k| &Number::from(k) * &over);
        let joint = if self.prismatic { slide_along_z(&c) } else { turn_about_z(&[c, s]) };
        compose(&self.before, &compose(&joint, &self.after))
    }
}

impl Arrangement {
    /// The numbers of its joints in the arm, from 1.
    fn joints(&self) -> Vec<usize> {
        self.order.iter().map(|joint| self.number(*joint)).collect()
    }

    /// The link at a place; where a joint that is given moves it, at one of three values of that joint.
    pub(super) fn link(&self, place: usize, sample: usize) -> Frame {
        let moved = self.given.as_ref().filter(|given| given.place == Some(place));
        moved.map_or_else(|| self.links[place].clone(), |given| given.link(sample))
    }

    fn kinds(&self) -> [bool; 3] {
        [self.prismatic[0], self.prismatic[1], self.prismatic[2]]
    }
}

/// The class of an arm with its virtual joints, or why it is of none.
pub(super) fn classify(chain: &Chain, target: Target, length: &Number) -> Result<InverseKinematics, String> {
    solved(chain, target, length, closed(chain, target).or_else(|| searched(chain, length)))
}

/// The same of classes whose solutions are not the roots of an equation that is sampled.
pub(super) fn closed_form(chain: &Chain, target: Target, length: &Number) -> Result<InverseKinematics, String> {
    solved(chain, target, length, closed(chain, target))
}

fn slides(chain: &Chain) -> usize {
    chain.joints.iter().filter(|joint| joint.prismatic).count()
}

fn closed(chain: &Chain, target: Target) -> Option<Class> {
    match (chain.joints.len(), slides(chain)) {
        (3, _) if target == Target::Position => position(chain, true).or_else(|| position(chain, false)),
        (4, _) => parallel_turns(chain),
        (6, 3) => three_prismatic(chain),
        (6, 0 | 1) => spherical_triple(chain, true).or_else(|| three_parallel(chain)).or_else(|| spherical_triple(chain, false)),
        (6, 2) => spherical_triple(chain, true).or_else(|| spherical_triple(chain, false)),
        _ => None,
    }
}

fn searched(chain: &Chain, length: &Number) -> Option<Class> {
    match (chain.joints.len(), slides(chain)) {
        (6, 0 | 1) => general(chain, length),
        (6, 2) => two_slides(chain, length),
        _ => None,
    }
}

fn solved(chain: &Chain, target: Target, length: &Number, found: Option<Class>) -> Result<InverseKinematics, String> {
    let none = || {
        let word = match target {
            Target::Pose => "a pose",
            Target::Planar => "a planar target",
            Target::Pointing => "a position and a direction",
            Target::Position => "a position",
        };
        let slides = match slides(chain) {
            0 => String::new(),
            slides => format!(", {slides} of them prismatic,"),
        };
        format!("there is no construction for {word} and {} joints{slides} of this geometry", chain.joints.len())
    };
    let Class { construction, class, most, choices } = found.ok_or_else(none)?;
    Ok(InverseKinematics {
        target,
        construction,
        class,
        most,
        choices,
        length: length.clone(),
        redundancy: None,
        own: None,
        coordinates: None,
    })
}

/// A class that fits.
struct Class {
    construction: Construction,
    class: String,
    most: usize,
    choices: Vec<Choice>,
}

/// Joints as a list in ascending order.
fn listed(joints: &[usize]) -> String {
    let mut joints = joints.to_vec();
    joints.sort_unstable();
    joints.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// Places 4, 5 and 6 of the loop turn about axes through one point.
fn spherical_triple(chain: &Chain, closed: bool) -> Option<Class> {
    chain.arrangements().find_map(|way| {
        let l = &way.links;
        let crosses = |f: &Frame| is_zero(&f[0][3]) && !is_parallel(f);
        let turning = way.prismatic[3..].iter().all(|slides| !slides);
        if !turning || !way.is_constant(3) || !way.is_constant(4) || !crosses(&l[3]) || !crosses(&l[4]) || !is_zero(&l[4][2][3]) {
            return None;
        }
        let case = regional_of(&way).filter(|case| case.closed == closed)?;
        let joints = way.joints();
        let because = case.because(&joints);
        let class = format!("spherical triple (axes {} through one point), {because}", listed(&joints[3..]));
        let mut choices = case.choices(&joints);
        choices.push(wrist(2, joints[4]));
        Some(Class { construction: Construction::SphericalTriple(way, case), class, most: 2 * case.most, choices })
    })
}

/// Places 2, 3 and 4 of the loop turn about parallel axes.
fn three_parallel(chain: &Chain) -> Option<Class> {
    chain.arrangements().find_map(|way| {
        let l = &way.links;
        let flat = |place: usize| way.is_constant(place) && is_parallel(&l[place]) && !is_zero(&l[place][0][3]);
        if way.prismatic.contains(&true) || !flat(1) || !flat(2) {
            return None;
        }
        // Axes b and c, or c and a, that intersect or are parallel leave two equations of block 1.
        let related = |place: usize| way.is_constant(place) && (is_zero(&l[place][0][3]) || is_parallel(&l[place]));
        let joints = way.joints();
        let (bc, ca) = (related(4), related(5));
        let mut class = format!("three parallel axes (joints {})", listed(&joints[1..4]));
        let pair = if bc { Some([joints[4], joints[5]]) } else { ca.then(|| [joints[5], joints[0]]) };
        if let Some([x, y]) = pair {
            class += &format!(", axes {} and {} intersect or are parallel", x.min(y), x.max(y));
        }
        // The equation that is free of the other joint comes first.
        let (first, last) = ((SHOULDER, Sign::Root(1)), (WRIST, Sign::Root(5)));
        let mut choices = match pair {
            None => vec![four(joints[0])],
            Some(_) => {
                let [(x, one), (y, other)] = if bc { [first, last] } else { [last, first] };
                vec![two(0, x, one.meaning(&joints)), two(1, y, other.meaning(&joints))]
            }
        };
        choices.push(two(2, ELBOW, Sign::Links.meaning(&joints)));
        Some(Class { construction: Construction::ThreeParallel(way, pair.is_none()), class, most: 8, choices })
    })
}

/// Seven revolute joints, the first three and the last three about axes through one point each: the swivel angle of the elbow is given.
pub(super) fn shoulder_elbow_wrist(chain: &Chain, length: &Number) -> Option<InverseKinematics> {
    if chain.joints.len() != 7 || chain.joints.iter().any(|joint| joint.prismatic) {
        return None;
    }
    let way = chain.arranged(0, false);
    let crosses = |place: usize| is_zero(&way.links[place][0][3]) && !is_parallel(&way.links[place]);
    let through_one = |place: usize| crosses(place) && crosses(place + 1) && is_zero(&way.links[place + 1][2][3]);
    if !through_one(0) || !through_one(4) {
        return None;
    }
    let choices = vec![two(0, ELBOW, Sign::Links.meaning(&[])), two(1, SHOULDER, "the sign of sin q2".into()), wrist(2, 6)];
    Some(InverseKinematics {
        target: Target::Pose,
        construction: Construction::ShoulderElbowWrist(way),
        class: "shoulder, elbow, wrist (axes 1 2 3 through one point, axes 5 6 7 through one point); the swivel angle of the elbow is given".into(),
        most: 8,
        choices,
        length: length.clone(),
        redundancy: Some(Redundancy::Swivel),
        own: None,
        coordinates: None,
    })
}

/// Four joints with parallel revolute axes. Place 4 of the loop is revolute, and the pose follows it.
fn parallel_turns(chain: &Chain) -> Option<Class> {
    chain.arrangements().find_map(|way| {
        if way.open != 3 || way.prismatic[3] {
            return None;
        }
        // Directions of axes seen from place 1: those of revolute joints are all ±e3 of the first of them.
        let mut since: Option<Frame> = None;
        for place in 0..4 {
            if !way.prismatic[place] {
                if since.as_ref().is_some_and(|between| !is_parallel(between)) {
                    return None;
                }
                since = Some(super::frame::identity());
            }
            since = since.map(|between| compose(&between, &way.link(place, 0)));
        }
        let case = regional_of(&way).filter(|case| case.closed)?;
        let joints = way.joints();
        let turning: Vec<usize> = (0..4).filter(|place| !way.prismatic[*place]).map(|place| joints[place]).collect();
        let class = format!("all revolute axes parallel (joints {})", listed(&turning));
        let choices = case.choices(&joints);
        Some(Class { construction: Construction::ParallelTurns(way, case), class, most: case.most, choices })
    })
}

/// Three joints that bring the end effector to a position.
fn position(chain: &Chain, closed: bool) -> Option<Class> {
    chain.arrangements().filter(|way| way.open == 2).find_map(|way| {
        let case = regional_of(&way).filter(|case| case.closed == closed)?;
        let joints = way.joints();
        let class = format!("position of three joints, {}", case.because(&joints));
        let choices = case.choices(&joints);
        Some(Class { construction: Construction::Position(way, case), class, most: case.most, choices })
    })
}

/// Three revolute joints, with neighbours at an angle, and three prismatic ones.
fn three_prismatic(chain: &Chain) -> Option<Class> {
    if chain.between.is_some() {
        return None;
    }
    chain.arrangements().find_map(|mut way| {
        let turning: Vec<usize> = (0..6).filter(|place| !way.prismatic[*place]).collect();
        let [r1, r2, r3] = turning[..] else { return None };
        if (r1..r3).contains(&way.open) || !turn_about_x(&mut way, r1, r2) || !turn_about_x(&mut way, r2, r3) {
            return None;
        }
        let joints = way.joints();
        let class = format!(
            "three prismatic joints (joints {})",
            listed(&(0..6).filter(|p| way.prismatic[*p]).map(|p| joints[p]).collect::<Vec<_>>())
        );
        let choices = vec![wrist(0, joints[r2])];
        Some(Class { construction: Construction::ThreePrismatic(way, [r1, r2, r3]), class, most: 2, choices })
    })
}

/// Four revolute and two prismatic joints. After the first, three revolute axes are at an angle to their neighbours.
fn two_slides(chain: &Chain, length: &Number) -> Option<Class> {
    if chain.between.is_some() {
        return None;
    }
    chain.arrangements().find_map(|mut way| {
        let places = |prismatic: bool| (1..6).filter(|place| way.prismatic[*place] == prismatic).collect::<Vec<_>>();
        let (&[a, b], &[r1, r2, r3]) = (places(true).as_slice(), places(false).as_slice()) else { return None };
        if way.prismatic[0] || (r1..r3).contains(&way.open) || stay_parallel(&way, a, b) {
            return None;
        }
        if !turn_about_x(&mut way, r1, r2) || !turn_about_x(&mut way, r2, r3) || !general::reaches(chain, &way, [a, b], length) {
            return None;
        }
        let joints = way.joints();
        let class = format!(
            "two prismatic joints (joints {}), with samples on the circle of q{}",
            listed(&[joints[a], joints[b]]),
            joints[0]
        );
        Some(Class { construction: Construction::TwoSlides(way, [a, b]), class, most: 8, choices: Vec::new() })
    })
}

/// Whether two slides are parallel in every posture: no link between them, on the side of the loop without the pose, turns an axis.
fn stay_parallel(way: &Arrangement, a: usize, b: usize) -> bool {
    let mut links = if (a..b).contains(&way.open) { (b..6).chain(0..a) } else { (a..b).chain(0..0) };
    links.all(|place| is_parallel(&way.links[place]))
}

/// Brings the rotation between the revolute joints at two places to one about x: R = Rz(t) Rx(alpha) Rz(t'), the turns about z going to the
/// joints. Whether their axes are at an angle.
fn turn_about_x(way: &mut Arrangement, from: usize, to: usize) -> bool {
    let between = way.links[from..to].iter().fold(super::frame::identity(), |product, link| compose(&product, link));
    if is_parallel(&between) {
        return false;
    }
    let Some([first, second]) = turns_beside_x(&between) else { return false };
    let back = |[c, s]: &[Number; 2]| turn_about_z(&[c.clone(), -s]);
    way.links[from] = compose(&back(&first), &way.links[from]);
    way.links[to - 1] = compose(&way.links[to - 1], &back(&second));
    way.offsets[from] = sum_of_angles(&way.offsets[from], &first);
    way.offsets[to] = sum_of_angles(&way.offsets[to], &second);
    true
}

/// Six joints of no class.
fn general(chain: &Chain, length: &Number) -> Option<Class> {
    if chain.between.is_some() {
        return None;
    }
    let ways = general::choose(chain, length)?;
    let places = |way: &Arrangement| way.joints().iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    let class = format!(
        "general (determinant on the circle of q{}, order {}; second order {})",
        ways[0].joints()[2],
        places(&ways[0]),
        places(&ways[1])
    );
    Some(Class { construction: Construction::General(Box::new(ways)), class, most: 16, choices: Vec::new() })
}
