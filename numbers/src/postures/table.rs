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
    coupled: Option<Coupled>,
}

/// Sums over the arm's joints or coordinates, zeros behind them.
#[derive(Clone, Debug)]
struct Sums {
    factors: [[Real; MOST_JOINTS]; MOST_JOINTS],
    offset: [Real; MOST_JOINTS],
}

/// The coordinates of coupled joints.
#[derive(Clone, Debug)]
struct Coupled {
    joints: Vec<bool>,
    variables: Sums,
    coordinates: Sums,
}

fn sums(of: &super::Sums<Real>, dof: usize) -> Result<Sums, Unsound> {
    if of.factors.len() != dof || of.offset.len() != dof || of.factors.iter().any(|row| row.len() != dof) {
        return Err(Unsound("a coupling"));
    }
    let entry = |i: usize, j: usize| of.factors.get(i).and_then(|row| row.get(j)).copied().unwrap_or(0.0);
    Ok(Sums {
        factors: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))),
        offset: std::array::from_fn(|i| of.offset.get(i).copied().unwrap_or(0.0)),
    })
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
    let coupled = of.coordinates.as_ref().map(|of| {
        if of.joints.len() != dof {
            return Err(Unsound("a coupling"));
        }
        Ok(Coupled { joints: of.joints.clone(), variables: sums(&of.variables, dof)?, coordinates: sums(&of.coordinates, dof)? })
    });
    let coupled = coupled.transpose()?;
    let prismatic = of.prismatic.clone();
    Ok(Table { prismatic, orientation: of.orientation, most: of.most, length: of.length, calls, given, own, coupled })
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

/// The most joints of an arm that has inverse kinematics.
const MOST_JOINTS: usize = 7;

/// One posture as the blocks take it. Joints behind those of the arm slide, stay at 0, and have no limits.
fn posture(q: &[Real]) -> block::Posture<MOST_JOINTS> {
    let q = std::array::from_fn(|joint| q.get(joint).copied().unwrap_or(0.0));
    block::Posture { q, branch: 0, double: false, free: 0 }
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
    fn slides(&self) -> [bool; MOST_JOINTS] {
        std::array::from_fn(|joint| self.prismatic.get(joint).copied().unwrap_or(true))
    }

    /// Whether a posture, which misses its pose by `miss`, is within the limits, into which it is moved.
    fn within(&self, q: &mut [Real], miss: Real, limits: impl Fn(usize) -> [Real; 2]) -> bool {
        let own = self.prismatic.len();
        let limits = |joint| if joint < own { limits(joint) } else { [Real::NEG_INFINITY, Real::INFINITY] };
        let alone = block::Postures { count: 1, miss, all: [posture(q)], ..block::Postures::<MOST_JOINTS, 1>::none(block::Verdict::Complete) };
        let within = alone.within(std::array::from_fn(limits), self.slides(), self.length);
        let moved = within.as_slice().first();
        if let Some(moved) = moved {
            q.iter_mut().zip(moved.q).for_each(|(own, moved)| *own = moved);
        }
        moved.is_some()
    }

    /// The number of the nearest of postures one after the other, found pair by pair: however many there are.
    fn nearest(&self, all: &[Real], q: &[Real]) -> Option<usize> {
        let q = posture(q).q;
        let mut nearest = None;
        for (number, next) in all.chunks(self.prismatic.len()).enumerate() {
            let next = posture(next);
            let known = nearest.map_or(next, |(_, known)| known);
            // The branch tells the two apart.
            let pair = [known, block::Posture { branch: 1, ..next }];
            let pair = block::Postures { count: 2, all: pair, ..block::Postures::none(block::Verdict::Complete) };
            let found = pair.nearest(&q, self.slides());
            if found.is_some_and(|found| found.branch == 1 || nearest.is_none()) {
                nearest = Some((number, next));
            }
        }
        nearest.map(|(number, _)| number)
    }

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
        let found = self.at(&at, redundancy);
        if !self.orientation || found.is_empty() {
            return found;
        }
        let one = block::Postures::<1, 1> { count: 1, ..block::Postures::none(block::Verdict::Complete) };
        Postures { miss: one.of_rotation(&[x, y, z]).miss, ..found }
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
                let links = at.with_moved(way.links_at(&at.t));
                let mut found = block::three_prismatic(&links, *turning);
                self.bring_to_the_pose(&mut found, &links, way, false);
                self.in_order::<5, 6, 7, 8>(at, way, found, false)
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
        match self.most {
            1 => self.at_most::<J, N, D, 1>(found, by_angle),
            2 => self.at_most::<J, N, D, 2>(found, by_angle),
            4 => self.at_most::<J, N, D, 4>(found, by_angle),
            8 => self.at_most::<J, N, D, 8>(found, by_angle),
            _ => self.at_most::<J, N, D, 16>(found, by_angle),
        }
    }

    fn at_most<const J: usize, const N: usize, const D: usize, const MOST: usize>(
        &self,
        found: &Branches<J, N>,
        by_angle: bool,
    ) -> Postures<Real> {
        let kinds = |of: &[bool]| std::array::from_fn(|joint| of.get(joint).copied().unwrap_or(false));
        let Some(Coupled { joints, coordinates, .. }) = &self.coupled else {
            return postures(&block::conclude::<J, N, D, MOST>(found, kinds(&self.prismatic), by_angle));
        };
        let joints = block::conclude::<J, N, D, MOST>(found, kinds(joints), by_angle);
        let factors = std::array::from_fn(|i| std::array::from_fn(|j| coordinates.factors[i][j]));
        let offset = std::array::from_fn(|i| coordinates.offset[i]);
        postures(&block::in_coordinates::<D, MOST>(&joints, factors, offset, kinds(&self.prismatic)))
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

    fn variables(table: &Table, q: &[Real]) -> Vec<Real> {
        let Some(Coupled { variables, .. }) = &table.coupled else { return q.to_vec() };
        let mut all = block::sums_of(&posture(q).q, variables.factors, variables.offset).to_vec();
        all.truncate(q.len());
        all
    }

    fn within(table: &Table, q: &mut [Real], miss: Real, limits: impl Fn(usize) -> [Real; 2]) -> bool {
        table.within(q, miss, limits)
    }

    fn nearest_of(table: &Table, all: &[Real], q: &[Real]) -> Option<usize> {
        table.nearest(all, q)
    }
}
