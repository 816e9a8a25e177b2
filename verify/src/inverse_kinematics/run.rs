//! Runs a module's function in double precision: with the constants of its text, and with building blocks compiled here from the same bytes.

use armgen_inverse_kinematics::f64 as block;

use super::text::{self, Construction, Text};

/// The module's verdict about its solutions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    Complete,
    Unreachable,
    NearDouble,
    Continuum,
}

/// The result of the function: for each solution (cos q, sin q) or (q, 0) of the joints.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    pub(super) verdict: Verdict,
    pub(super) solutions: Vec<Vec<[f64; 2]>>,
}

type Case = fn(&block::Frame, &block::Frame, block::Vector, block::Vector) -> block::Branches<3, 4>;

fn case(name: &str) -> Option<Case> {
    Some(match name {
        "regional_elbow" => block::regional_elbow,
        "regional_crossing" => block::regional_crossing,
        "regional_general" => block::regional_general,
        "regional_slide_elbow" => block::regional_slide_elbow,
        "regional_slide_across" => block::regional_slide_across,
        "regional_slide" => block::regional_slide,
        "regional_mid_slide_elbow" => block::regional_mid_slide_elbow,
        "regional_mid_slide_across" => block::regional_mid_slide_across,
        "regional_mid_slide" => block::regional_mid_slide,
        "regional_plane_then_turn" => block::regional_plane_then_turn,
        "regional_slide_turn_slide" => block::regional_slide_turn_slide,
        "regional_slides" => block::regional_slides,
        _ => return None,
    })
}

fn arrangement<const J: usize>(way: &text::Arrangement) -> Option<block::Arrangement<J>> {
    let numbers: Option<Vec<f64>> = way.numbers.iter().map(|x| x.parse().ok()).collect();
    let numbers = numbers.filter(|_| way.order.len() == J)?;
    let frame = |at: usize| -> block::Frame { std::array::from_fn(|i| std::array::from_fn(|j| numbers[at + 4 * i + j])) };
    Some(block::Arrangement {
        order: std::array::from_fn(|i| way.order[i]),
        prismatic: std::array::from_fn(|i| way.prismatic[i]),
        links: std::array::from_fn(|i| frame(12 * i)),
        open: way.open,
        before: frame(12 * J),
        after: frame(12 * J + 12),
        backward: way.backward,
        offsets: std::array::from_fn(|i| [numbers[12 * J + 24 + 2 * i], numbers[12 * J + 25 + 2 * i]]),
    })
}

/// The conclusion as in the text `solutions`, which first removes virtual joints, if any; they must come out 0.
fn concluded<const J: usize, const N: usize>(text: &Text, t: &block::Frame, found: &block::Branches<J, N>) -> Option<Outcome> {
    let Some(own) = &text.own else { return Some(listed(text, found)) };
    let (arm, length) = (arrangement::<6>(own)?, text.length.parse().ok()?);
    let rows = if text.construction == Construction::General { block::GENERAL_ROWS } else { block::ROUNDING };
    Some(match text.dof {
        1 => listed(text, &block::without_virtual_joints::<J, 1, N>(&arm, found, t, length, rows)),
        2 => listed(text, &block::without_virtual_joints::<J, 2, N>(&arm, found, t, length, rows)),
        3 => listed(text, &block::without_virtual_joints::<J, 3, N>(&arm, found, t, length, rows)),
        4 => listed(text, &block::without_virtual_joints::<J, 4, N>(&arm, found, t, length, rows)),
        5 => listed(text, &block::without_virtual_joints::<J, 5, N>(&arm, found, t, length, rows)),
        _ => return None,
    })
}

fn listed<const J: usize, const N: usize>(text: &Text, found: &block::Branches<J, N>) -> Outcome {
    let dof = text.dof - usize::from(text.given.is_some());
    let (mut near, mut continuum) = (found.near, found.continuum);
    let mut solutions = Vec::new();
    for branch in found.found() {
        let joints: Vec<[f64; 2]> = branch.joints.iter().take(dof).copied().collect();
        if !joints.iter().flatten().all(|x| x.is_finite()) || solutions.len() == text.most {
            near = true;
            continue;
        }
        near |= branch.double;
        continuum |= branch.free & ((1 << dof) - 1) != 0;
        solutions.push(joints);
    }
    let verdict = match (continuum, near, solutions.is_empty()) {
        (true, ..) => Verdict::Continuum,
        (_, true, _) => Verdict::NearDouble,
        (_, _, false) => Verdict::Complete,
        _ => Verdict::Unreachable,
    };
    Outcome { verdict, solutions }
}

fn in_order<const J: usize, const N: usize>(
    text: &Text,
    t: &block::Frame,
    way: &block::Arrangement<J>,
    mut found: block::Branches<J, N>,
) -> Option<Outcome> {
    let count = found.count;
    for branch in found.all.iter_mut().take(count) {
        *branch = way.of_arm(branch);
    }
    concluded(text, t, &found)
}

/// The result of the function at a pose; `None` if its text cannot be run.
///
/// - `redundancy`: the value of the given joint, if any.
pub(super) fn run(text: &Text, t: &block::Frame, redundancy: f64) -> Option<Outcome> {
    let Some(given) = &text.given else {
        return match text.construction {
            Construction::ShoulderElbowWrist => {
                let way = arrangement::<7>(&text.loops[0])?;
                in_order(text, t, &way, block::shoulder_elbow_wrist(&way, t, redundancy))
            }
            _ => of_rest(text, t, None, [0.0; 3]),
        };
    };
    let numbers: Option<Vec<f64>> = given.numbers.iter().map(|x| x.parse().ok()).collect();
    let numbers = numbers?;
    let frame = |at: usize| -> block::Frame { std::array::from_fn(|i| std::array::from_fn(|j| numbers[at + 4 * i + j])) };
    let joint = block::Given { joint: given.joint, prismatic: given.prismatic, before: frame(0), after: frame(12) };
    let value = joint.value(redundancy);
    let link = joint.link(value);
    let mut outcome = match given.place {
        // A position does not determine the orientation of the last joint's motion.
        None if !text.rotation && given.joint > 0 => of_rest(text, t, None, block::column(&link, 3))?,
        None => of_rest(text, &joint.rest(value, t), None, [0.0; 3])?,
        Some(place) => of_rest(text, t, Some((place, link)), [0.0; 3])?,
    };
    for solution in &mut outcome.solutions {
        solution.insert(given.joint, value);
    }
    Some(outcome)
}

/// The same for the joints that are not given. `tip`: the point at the position, relative to the frame after them.
fn of_rest(text: &Text, t: &block::Frame, moved: Option<(usize, block::Frame)>, tip: block::Vector) -> Option<Outcome> {
    fn with_moved<const J: usize>(mut links: [block::Frame; J], moved: Option<(usize, block::Frame)>) -> [block::Frame; J] {
        if let Some((place, link)) = moved {
            links[place] = link;
        }
        links
    }
    let finish = |found: &mut block::Branches<6, 8>, closing: &block::Loop<6>, polished: bool| match (polished, &text.own) {
        (true, _) => block::polish(found, closing),
        (false, None) => block::close_where_solutions_meet(found, closing),
        (false, Some(_)) => {}
    };
    let links_at = |way: &block::Arrangement<6>| with_moved(way.links_at(t), moved);
    let length: f64 = text.length.parse().ok()?;
    let first = &text.loops[0];
    match &text.construction {
        Construction::ShoulderElbowWrist => None,
        Construction::General => {
            let ways = [arrangement::<6>(first)?, arrangement::<6>(&text.loops[1])?];
            concluded(text, t, &block::general_arm(&ways, t, length))
        }
        Construction::SphericalTriple { kinds, case: name, polished } => {
            let (way, kinds) = (arrangement::<6>(first)?, [kinds[0], kinds[1], kinds[2]]);
            let links = links_at(&way);
            let mut found = block::spherical_triple(&links, kinds, case(name)?);
            finish(&mut found, &block::Loop { links: &links, prismatic: way.prismatic, target: [0.0; 3], length }, *polished);
            in_order(text, t, &way, found)
        }
        Construction::ThreeParallel { polished } => {
            let way = arrangement::<6>(first)?;
            let links = links_at(&way);
            let mut found = block::three_parallel(&links);
            finish(&mut found, &block::Loop { links: &links, prismatic: way.prismatic, target: [0.0; 3], length }, *polished);
            in_order(text, t, &way, found)
        }
        Construction::ParallelTurns { kinds, case: name } => {
            let way = arrangement::<4>(first)?;
            let links = with_moved(way.links_at(t), moved);
            in_order(text, t, &way, block::parallel_turns(&links, [kinds[0], kinds[1], kinds[2]], case(name)?))
        }
        Construction::ThreePrismatic { turning } => {
            let way = arrangement::<6>(first)?;
            let links = links_at(&way);
            let mut found = block::three_prismatic(&links, [turning[0], turning[1], turning[2]]);
            finish(&mut found, &block::Loop { links: &links, prismatic: way.prismatic, target: [0.0; 3], length }, false);
            in_order(text, t, &way, found)
        }
        Construction::TwoSlides { slides } => {
            let way = arrangement::<6>(first)?;
            in_order(text, t, &way, block::two_slides(&way.links_at(t), [slides[0], slides[1]], length))
        }
        Construction::Position { case: name, polished } => {
            let way = arrangement::<3>(first)?;
            let [a, b, _] = with_moved(way.links, moved);
            let position = block::column(t, 3);
            let (from, to) = if way.backward {
                (block::transform(&way.before, position), block::transform(&block::inverse(&way.after), tip))
            } else {
                (block::transform(&way.before, tip), block::transform(&block::inverse(&way.after), position))
            };
            let mut found = case(name)?(&a, &b, from, to);
            if *polished {
                let links = [a, b, block::displaced(from)];
                block::polish(&mut found, &block::Loop { links: &links, prismatic: way.prismatic, target: to, length });
            }
            in_order(text, t, &way, found)
        }
    }
}
