// The calls of the blocks by construction and number of joints, for one scalar: compiled for both.

use super::{Construction, InverseKinematics, Postures, Redundancy, Solved, Unsound, Verdict};
use block::{Arrangement, Branches, Frame, Given, Loop, Real, Vector};

/// A case of block 6.
type Regional = fn(&Frame, &Frame, Vector, Vector) -> Branches<3, 4>;

/// A construction with its loops as the blocks take them.
#[derive(Clone, Debug)]
enum Calls {
    SphericalTriple(Arrangement<6>, Regional, bool),
    ThreeParallel(Arrangement<6>, bool),
    ParallelTurns(Arrangement<4>, Regional),
    Position(Arrangement<3>, Regional, bool),
    ThreePrismatic(Arrangement<6>, [usize; 3]),
    TwoSlides(Arrangement<6>, [usize; 2]),
    ShoulderElbowWrist(Arrangement<7>),
    General(Box<[Arrangement<6>; 2]>),
}

/// The data of a call.
#[derive(Clone, Debug)]
pub struct Table {
    prismatic: Vec<bool>,
    orientation: bool,
    most: usize,
    length: Real,
    calls: Calls,
    given: Option<(Given, Option<usize>)>,
    own: Option<Arrangement<6>>,
}

fn regional(case: super::Case) -> Regional {
    use super::Case;
    match case {
        Case::Elbow => block::regional_elbow,
        Case::Crossing => block::regional_crossing,
        Case::General => block::regional_general,
        Case::SlideElbow => block::regional_slide_elbow,
        Case::SlideAcross => block::regional_slide_across,
        Case::Slide => block::regional_slide,
        Case::MidSlideElbow => block::regional_mid_slide_elbow,
        Case::MidSlideAcross => block::regional_mid_slide_across,
        Case::MidSlide => block::regional_mid_slide,
        Case::PlaneThenTurn => block::regional_plane_then_turn,
        Case::SlideTurnSlide => block::regional_slide_turn_slide,
        Case::Slides => block::regional_slides,
    }
}

/// A loop of J joints.
fn arrangement<const J: usize>(way: &super::Arrangement<Real>) -> Result<Arrangement<J>, Unsound> {
    let all = |n: usize| n == J;
    let mut sorted = way.order.clone();
    sorted.sort_unstable();
    let whole = all(way.prismatic.len()) && all(way.links.len()) && all(way.offsets.len()) && way.open < J;
    if !whole || !sorted.into_iter().eq(0..J) {
        return Err(Unsound("a loop"));
    }
    Ok(Arrangement {
        order: std::array::from_fn(|i| way.order[i]),
        prismatic: std::array::from_fn(|i| way.prismatic[i]),
        links: std::array::from_fn(|i| way.links[i]),
        open: way.open,
        before: way.before,
        after: way.after,
        backward: way.backward,
        offsets: std::array::from_fn(|i| way.offsets[i]),
    })
}

/// Whether the places are consecutive.
fn is_ascending(places: &[usize]) -> bool {
    places.windows(2).all(|pair| pair[0] < pair[1]) && places.iter().all(|place| *place < 6)
}

fn table(of: &InverseKinematics<Real>) -> Result<Table, Unsound> {
    let (calls, joints) = match &of.construction {
        Construction::SphericalTriple(way, case) => (Calls::SphericalTriple(arrangement(way)?, regional(*case), !case.is_closed()), 6),
        Construction::ThreeParallel(way, polished) => (Calls::ThreeParallel(arrangement(way)?, *polished), 6),
        Construction::ParallelTurns(way, case) => (Calls::ParallelTurns(arrangement(way)?, regional(*case)), 4),
        Construction::Position(way, case) => (Calls::Position(arrangement(way)?, regional(*case), !case.is_closed()), 3),
        Construction::ThreePrismatic(way, turning) if is_ascending(turning) => (Calls::ThreePrismatic(arrangement(way)?, *turning), 6),
        Construction::TwoSlides(way, slides) if is_ascending(slides) => (Calls::TwoSlides(arrangement(way)?, *slides), 6),
        Construction::ShoulderElbowWrist(way) => (Calls::ShoulderElbowWrist(arrangement(way)?), 7),
        Construction::General(ways) => (Calls::General(Box::new([arrangement(&ways[0])?, arrangement(&ways[1])?])), 6),
        _ => return Err(Unsound("a list of places")),
    };
    let given = match &of.redundancy {
        Some(Redundancy::Joint(given)) => {
            let block = Given { joint: given.joint, prismatic: given.prismatic, before: given.before, after: given.after };
            Some((block, given.place))
        }
        _ => None,
    };
    let swivel = matches!(of.redundancy, Some(Redundancy::Swivel));
    if swivel != matches!(calls, Calls::ShoulderElbowWrist(_)) {
        return Err(Unsound("the redundancy"));
    }
    let dof = of.prismatic.len();
    let moved = |(given, place): &(Given, Option<usize>)| given.joint < dof && place.is_none_or(|place| place < joints);
    if !given.as_ref().is_none_or(moved) {
        return Err(Unsound("the joint that is given"));
    }
    // Joints after the arm's are virtual. There is at most one, except in a loop of the arm's own joints.
    let all = joints + usize::from(given.is_some());
    let fits = match (&of.own, &given) {
        (None, _) => dof == all || dof + 1 == all && !swivel,
        (Some(_), None) => (1..6).contains(&dof),
        (Some(_), Some(_)) => false,
    };
    // A capacity of the construction's solutions holds them.
    let capacity = match calls {
        Calls::General(_) => 16,
        Calls::ParallelTurns(..) | Calls::Position(..) => 4,
        _ => 8,
    };
    if !fits || !of.most.is_power_of_two() || of.most > capacity {
        return Err(Unsound("the number of joints or of solutions"));
    }
    if of.orientation == matches!(calls, Calls::Position(..)) {
        return Err(Unsound("the target"));
    }
    let own = of.own.as_ref().map(arrangement).transpose()?;
    Ok(Table { prismatic: of.prismatic.clone(), orientation: of.orientation, most: of.most, length: of.length, calls, given, own })
}

/// The result as it is handed on.
fn postures<const JOINTS: usize, const MOST: usize>(found: &block::Postures<JOINTS, MOST>) -> Postures<Real> {
    let all = found.as_slice();
    Postures {
        verdict: match found.verdict {
            block::Verdict::Complete => Verdict::Complete,
            block::Verdict::Unreachable => Verdict::Unreachable,
            block::Verdict::NearDouble => Verdict::NearDouble,
            block::Verdict::Continuum => Verdict::Continuum,
            block::Verdict::Invalid => Verdict::Invalid,
        },
        miss: found.miss,
        q: all.iter().flat_map(|one| one.q).collect(),
        branch: all.iter().map(|one| one.branch).collect(),
        double: all.iter().map(|one| one.double).collect(),
        free: all.iter().map(|one| one.free).collect(),
    }
}

/// Arguments of a call that all constructions share.
struct At {
    /// The pose that the joints of the loop have to reach.
    t: Frame,
    /// The position likewise.
    position: Vector,
    /// The point at this position in the frame after the loop's joints, unless it is the origin of that frame.
    tip: Option<Vector>,
    /// The value of the given joint.
    value: [Real; 2],
    /// The link that it moves, with its place.
    moved: Option<(usize, Frame)>,
}

impl At {
    fn with_moved<const J: usize>(&self, mut links: [Frame; J]) -> [Frame; J] {
        if let Some((place, link)) = self.moved {
            links[place] = link;
        }
        links
    }
}

impl Table {
    fn solve(&self, t: &[[Real; 4]; 4], redundancy: Option<Real>) -> Postures<Real> {
        let is_target = if self.orientation { block::is_pose(t) } else { block::all_finite(t) };
        if !is_target || redundancy.is_some_and(|value| !value.is_finite()) {
            return postures(&block::Postures::<1, 1>::none(block::Verdict::Invalid));
        }
        let redundancy = redundancy.unwrap_or(0.0);
        let [x, y, z, _] = *t;
        let mut at = At { t: [x, y, z], position: [x[3], y[3], z[3]], tip: None, value: [0.0; 2], moved: None };
        if let Some((given, place)) = &self.given {
            at.value = given.value(redundancy);
            match place {
                Some(place) => at.moved = Some((*place, given.link(at.value))),
                None if self.orientation => at.t = given.rest(at.value, &at.t),
                None if given.joint == 0 => {
                    at.position = block::transform(&block::inverse(&given.link(at.value)), at.position);
                }
                None => at.tip = Some(block::column(&given.link(at.value), 3)),
            }
        }
        self.at(&at, redundancy)
    }

    fn at(&self, at: &At, redundancy: Real) -> Postures<Real> {
        let length = self.length;
        match &self.calls {
            Calls::SphericalTriple(way, case, polished) => {
                let links = at.with_moved(way.links_at(&at.t));
                let kinds = [way.prismatic[0], way.prismatic[1], way.prismatic[2]];
                let mut found = block::spherical_triple(&links, kinds, case);
                self.bring_to_the_pose(&mut found, &links, way, *polished);
                self.in_order::<5, 6, 7, 8>(at, way, found, false)
            }
            Calls::ThreeParallel(way, polished) => {
                let links = at.with_moved(way.links_at(&at.t));
                let mut found = block::three_parallel(&links);
                self.bring_to_the_pose(&mut found, &links, way, *polished);
                self.in_order::<5, 6, 7, 8>(at, way, found, false)
            }
            Calls::ParallelTurns(way, case) => {
                let links = at.with_moved(way.links_at(&at.t));
                let kinds = [way.prismatic[0], way.prismatic[1], way.prismatic[2]];
                self.in_order::<3, 4, 5, 4>(at, way, block::parallel_turns(&links, kinds, case), false)
            }
            Calls::Position(way, case, polished) => {
                let [a, b, _] = at.with_moved(way.links);
                let end = |frame: &Frame| at.tip.map_or_else(|| block::column(frame, 3), |tip| block::transform(frame, tip));
                let (from, to) = if way.backward {
                    (block::transform(&way.before, at.position), end(&block::inverse(&way.after)))
                } else {
                    (end(&way.before), block::transform(&block::inverse(&way.after), at.position))
                };
                let mut found = case(&a, &b, from, to);
                if *polished {
                    let links = [a, b, block::displaced(from)];
                    block::polish(&mut found, &Loop { links: &links, prismatic: way.prismatic, target: to, length });
                }
                self.in_order::<2, 3, 4, 4>(at, way, found, false)
            }
            Calls::ThreePrismatic(way, turning) => {
                self.in_order::<5, 6, 7, 8>(at, way, block::three_prismatic(&way.links_at(&at.t), *turning), false)
            }
            Calls::TwoSlides(way, slides) => {
                self.in_order::<5, 6, 7, 8>(at, way, block::two_slides(&way.links_at(&at.t), *slides, length), true)
            }
            Calls::ShoulderElbowWrist(way) => {
                let mut found = block::shoulder_elbow_wrist(way, &at.t, redundancy);
                in_arms_order(way, &mut found);
                self.concluded::<7, 8, 7>(&found, false)
            }
            Calls::General(ways) => self.finished::<5, 6, 7, 16>(at, &block::general_arm(ways, &at.t, length), true),
        }
    }

    /// The solutions of the arm's own joints are refined later.
    fn bring_to_the_pose(&self, found: &mut Branches<6, 8>, links: &[Frame; 6], way: &Arrangement<6>, polished: bool) {
        if self.own.is_none() {
            let closing = Loop { links, prismatic: way.prismatic, target: [0.0; 3], length: self.length };
            if polished {
                block::polish(found, &closing);
            } else {
                block::close_where_solutions_meet(found, &closing);
            }
        }
    }

    /// Solutions of a loop of J joints, where I = J - 1 and K = J + 1.
    fn in_order<const I: usize, const J: usize, const K: usize, const N: usize>(
        &self,
        at: &At,
        way: &Arrangement<J>,
        mut found: Branches<J, N>,
        by_angle: bool,
    ) -> Postures<Real> {
        in_arms_order(way, &mut found);
        self.finished::<I, J, K, N>(at, &found, by_angle)
    }

    /// Solutions in the arm's order, with the joint that is given, without virtual joints.
    fn finished<const I: usize, const J: usize, const K: usize, const N: usize>(
        &self,
        at: &At,
        found: &Branches<J, N>,
        by_angle: bool,
    ) -> Postures<Real> {
        let dof = self.prismatic.len();
        if let Some(arm) = &self.own {
            return match dof {
                1 => self.own_joints::<J, 1, N>(arm, at, found, by_angle),
                2 => self.own_joints::<J, 2, N>(arm, at, found, by_angle),
                3 => self.own_joints::<J, 3, N>(arm, at, found, by_angle),
                4 => self.own_joints::<J, 4, N>(arm, at, found, by_angle),
                _ => self.own_joints::<J, 5, N>(arm, at, found, by_angle),
            };
        }
        match &self.given {
            Some((given, _)) => {
                let all = given.with::<J, K, N>(found, at.value);
                if dof == K {
                    self.concluded::<K, N, K>(&all, by_angle)
                } else {
                    self.concluded::<K, N, J>(&all, by_angle)
                }
            }
            None if dof == J => self.concluded::<J, N, J>(found, by_angle),
            None => self.concluded::<J, N, I>(found, by_angle),
        }
    }

    fn own_joints<const V: usize, const D: usize, const N: usize>(
        &self,
        arm: &Arrangement<6>,
        at: &At,
        found: &Branches<V, N>,
        by_angle: bool,
    ) -> Postures<Real> {
        let rows = if matches!(self.calls, Calls::General(_)) { block::GENERAL_ROWS } else { block::ROUNDING };
        let own = block::without_virtual_joints::<V, D, N>(arm, found, &at.t, self.length, rows);
        self.concluded::<D, N, D>(&own, by_angle)
    }

    fn concluded<const J: usize, const N: usize, const D: usize>(&self, found: &Branches<J, N>, by_angle: bool) -> Postures<Real> {
        let kinds = std::array::from_fn(|joint| self.prismatic.get(joint).copied().unwrap_or(false));
        match self.most {
            1 => postures(&block::conclude::<J, N, D, 1>(found, kinds, by_angle)),
            2 => postures(&block::conclude::<J, N, D, 2>(found, kinds, by_angle)),
            4 => postures(&block::conclude::<J, N, D, 4>(found, kinds, by_angle)),
            8 => postures(&block::conclude::<J, N, D, 8>(found, kinds, by_angle)),
            _ => postures(&block::conclude::<J, N, D, 16>(found, kinds, by_angle)),
        }
    }
}

fn in_arms_order<const J: usize, const N: usize>(way: &Arrangement<J>, found: &mut Branches<J, N>) {
    let count = found.count;
    for branch in found.all.iter_mut().take(count) {
        *branch = way.of_arm(branch);
    }
}

impl Solved for Real {
    type Table = Table;

    fn table(of: &InverseKinematics<Real>) -> Result<Table, Unsound> {
        table(of)
    }

    fn solve(table: &Table, pose: &[[Real; 4]; 4], redundancy: Option<Real>) -> Postures<Real> {
        table.solve(pose, redundancy)
    }

    fn swivel(table: &Table, q: &[Real]) -> Option<Real> {
        match (&table.calls, q.try_into()) {
            (Calls::ShoulderElbowWrist(way), Ok(q)) => Some(block::swivel_angle(way, &q)),
            _ => None,
        }
    }
}
