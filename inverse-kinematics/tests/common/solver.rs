// A solver for whole arms: classifies an arm by its numbers, to 1e-9, and puts the blocks together. For tests alone: 1e-9 is not 0, and the
// choice of arrangements by trial belongs where an arm's description is read.

/// What an arm of six joints, or four with parallel axes, is solved by.
#[derive(Clone, Debug)]
pub enum Plan {
    SphericalTriple { way: Arrangement<6>, regional: Regional },
    /// `related`: axes b and c, or c and a, intersect or are parallel.
    ThreeParallel { way: Arrangement<6>, related: bool },
    ParallelTurns { way: Arrangement<4>, regional: Regional },
    General { ways: Box<[Arrangement<6>; 2]> },
}

/// A case of block 6.
pub type Block = fn(&Frame, &Frame, Vector, Vector) -> Branches<3, 4>;

#[derive(Clone, Copy, Debug)]
pub struct Regional {
    pub name: &'static str,
    pub block: Block,
    /// Closed forms throughout, which need no polishing.
    pub exact: bool,
}

const ZERO: Real = if UNIT_ROUNDOFF < 1e-10 { 1e-9 } else { 1e-5 };

fn zero(x: Real) -> bool {
    x.abs() < ZERO
}

fn about_z(c: Real, s: Real) -> Frame {
    joint_then(false, [c, s], &IDENTITY)
}

/// (theta, (d, a, alpha), (theta', d')) of a link Rz(theta) Tz(d) Tx(a) Rx(alpha) Rz(theta') Tz(d').
fn normal_form(f: &Frame) -> ([Real; 2], Frame, ([Real; 2], Real)) {
    let (z, t) = (column(f, 2), column(f, 3));
    let sine = length(z[0], z[1]);
    let (theta, d, a, ca, sa, d2);
    if sine > ZERO {
        // The common normal: e3 × z.
        let n = [-z[1] / sine, z[0] / sine];
        theta = n;
        a = n[0] * t[0] + n[1] * t[1];
        (ca, sa) = (z[2], sine);
        // t = d e3 + a n + d' z
        d2 = (z[0] * t[0] + z[1] * t[1]) / (sine * sine);
        d = t[2] - d2 * z[2];
    } else {
        let r = length(t[0], t[1]);
        theta = if r > ZERO { [t[0] / r, t[1] / r] } else { [1.0, 0.0] };
        a = if r > ZERO { r } else { 0.0 };
        (ca, sa) = (z[2].signum(), 0.0);
        (d, d2) = (t[2], 0.0);
    }
    let snap = |x: Real| if zero(x) { 0.0 } else { x };
    let (a, d, d2, ca, sa) = (snap(a), snap(d), snap(d2), if zero(ca) { 0.0 } else { ca }, sa);
    let middle: Frame = [[1.0, 0.0, 0.0, a], [0.0, ca, -sa, 0.0], [0.0, sa, ca, d]];
    let front = compose(&about_z(theta[0], theta[1]), &middle);
    let rest = compose(&inverse(&front), f);
    let over = 1.0 / length(rest[0][0], rest[1][0]);
    (theta, middle, ([rest[0][0] * over, rest[1][0] * over], d2))
}

/// The arrangement from joint `start` on, with the links between revolute joints in normal form if `normal`.
pub fn arrangement<const N: usize>(arm: &Arm, start: usize, backward: bool, normal: bool) -> Arrangement<N> {
    let order: [usize; N] = std::array::from_fn(|i| if backward { (start + N - i) % N } else { (start + i) % N });
    let prismatic = order.map(|i| arm.prismatic[i]);
    // The link behind arm's joint N - 1 is the open one: after it forwards, before joint N - 1 in the loop's order backwards.
    let number = |i: usize| if backward { (order[i] + N - 1) % N } else { order[i] };
    let open = (0..N).find(|i| number(*i) == N - 1).unwrap();
    let mut links: [Frame; N] = std::array::from_fn(|i| {
        let f = if number(i) == N - 1 { IDENTITY } else { arm.c[number(i) + 1] };
        if backward { reversed(&f) } else { f }
    });
    // Forwards Cn T⁻¹ C0; backwards F C0⁻¹ T Cn⁻¹ F.
    let flip: Frame = [[1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0]];
    let (mut before, mut after) = if backward {
        (compose(&flip, &inverse(&arm.c[0])), compose(&inverse(&arm.c[N]), &flip))
    } else {
        (arm.c[N], arm.c[0])
    };
    let mut offsets = prismatic.map(|p| if p { [0.0, 0.0] } else { [1.0, 0.0] });
    if normal {
        // From behind the open link on: what a link leaves over goes to the next.
        let (mut turn_left, mut slide_left) = ([1.0, 0.0], 0.0);
        for k in 1..=N {
            let i = (open + k) % N;
            let next = (i + 1) % N;
            let slide = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, slide_left]];
            if prismatic[i] {
                // The turn stays in front of what follows; nothing is left over for a prismatic joint.
                (turn_left, slide_left) = ([1.0, 0.0], 0.0);
                continue;
            }
            let mut offset = turn_left;
            if i == open {
                before = compose(&slide, &before);
            } else if prismatic[next] {
                links[i] = compose(&slide, &links[i]);
            }
            (turn_left, slide_left) = ([1.0, 0.0], 0.0);
            if i != open && !prismatic[next] {
                let (theta, middle, left) = normal_form(&links[i]);
                links[i] = compose(&slide, &middle);
                offset = [offset[0] * theta[0] - offset[1] * theta[1], offset[1] * theta[0] + offset[0] * theta[1]];
                (turn_left, slide_left) = left;
            }
            offsets[i] = offset;
        }
    }
    let _ = &mut after;
    Arrangement { order, prismatic, links, open, before, after, backward, offsets }
}

/// The case of block 6 for three joints of given kinds with links A, B (constant where so said, in normal form between revolute joints).
fn regional(kinds: [bool; 3], a: &Frame, b: &Frame, constant: bool) -> Option<Regional> {
    let is = |name, block: Block, exact| Some(Regional { name, block, exact });
    let parallel = |f: &Frame| zero(f[2][0]) && zero(f[2][1]);
    let right = |f: &Frame| zero(f[2][2]);
    let chain = compose(a, b);
    if !constant {
        return match kinds {
            [false, false, false] => is("general", regional_general, false),
            _ => None,
        };
    }
    match kinds {
        [false, false, false] if parallel(b) && b[0][3] != 0.0 => is("elbow", regional_elbow, true),
        [false, false, false] if a[0][3] == 0.0 && !parallel(a) => is("crossing", regional_crossing, true),
        [false, false, false] if !parallel(a) && !parallel(b) && b[0][3] != 0.0 => is("general", regional_general, false),
        [true, false, false] if parallel(b) && !right(a) => is("slide and elbow", regional_slide_elbow, true),
        [true, false, false] if right(a) => is("slide across", regional_slide_across, true),
        [true, false, false] if !parallel(b) => is("slide", regional_slide, false),
        [false, true, false] if parallel(&chain) && !right(a) => is("slide between parallel axes", regional_mid_slide_elbow, true),
        [false, true, false] if right(a) => is("slide between, across", regional_mid_slide_across, true),
        [false, true, false] => is("slide between", regional_mid_slide, false),
        [true, true, false] => is("plane, then turn", regional_plane_then_turn, true),
        [true, false, true] => is("slide, turn, slide", regional_slide_turn_slide, true),
        [true, true, true] => is("slides", regional_slides, true),
        _ => None,
    }
}

/// The plan of an arm: the first of its class by start and direction, exact ones first.
pub fn plan(arm: &Arm) -> Plan {
    if arm.joints() == 4 {
        for backward in [false, true] {
            for start in 0..4 {
                let way = arrangement::<4>(arm, start, backward, false);
                let [a, b, c, d] = way.prismatic;
                // The open link keeps axes parallel by what is asked for; block 6 then sees constants only if it is the last.
                if d || way.open != 3 {
                    continue;
                }
                let [l1, l2, ..] = way.links;
                let flat = |i: usize, j: usize| !way.prismatic[i] && !way.prismatic[j];
                let way = if flat(0, 1) || flat(1, 2) { arrangement::<4>(arm, start, backward, true) } else { way };
                let _ = (l1, l2);
                if let Some(regional) = regional([a, b, c], &way.links[0], &way.links[1], true).filter(|r| r.exact) {
                    return Plan::ParallelTurns { way, regional };
                }
            }
        }
        panic!("four joints without a class: {arm:?}");
    }
    for exact in [true, false] {
        for backward in [false, true] {
            for start in 0..6 {
                let way = arrangement::<6>(arm, start, backward, true);
                let all = |range: std::ops::Range<usize>| range.into_iter().all(|i| !way.prismatic[i]);
                let l = &way.links;
                let crosses = |f: &Frame| f[0][3] == 0.0 && f[2][1].abs() > ZERO;
                let triple = all(3..6) && way.open != 3 && way.open != 4 && crosses(&l[3]) && crosses(&l[4]) && l[4][2][3] == 0.0;
                if triple {
                    let kinds = [way.prismatic[0], way.prismatic[1], way.prismatic[2]];
                    if let Some(regional) = regional(kinds, &l[0], &l[1], way.open != 0 && way.open != 1).filter(|r| r.exact == exact) {
                        return Plan::SphericalTriple { way, regional };
                    }
                }
                let flat = |i: usize| way.open != i && zero(l[i][2][1]) && l[i][0][3] != 0.0;
                if exact && all(0..6) && flat(1) && flat(2) {
                    let related = |i: usize| way.open != i && (l[i][0][3] == 0.0 || zero(l[i][2][1]));
                    return Plan::ThreeParallel { way, related: related(4) || related(5) };
                }
            }
        }
    }
    Plan::General { ways: Box::new(general_ways(arm, 40)) }
}

/// The arrangement of block 8 with the fewest doubtful ones of some random poses, then with the least noise; and the next that leaves another joint for
/// last.
pub fn general_ways(arm: &Arm, poses: usize) -> [Arrangement<6>; 2] {
    let mut ways = vec![];
    for backward in [false, true] {
        for start in 0..6 {
            let way = arrangement::<6>(arm, start, backward, false);
            let [p1, p2, p3, p4, p5, p6] = way.prismatic;
            if p3 || p6 || (p4 && p5) || ((p1 || p2) && (p4 || p5)) {
                continue;
            }
            let random = &mut Random(99);
            let (mut doubtful, mut noise) = (0, 0.0);
            for _ in 0..poses {
                let t = arm.at(&arm.posture(random));
                let result = determinant_on_circle(&way.links_at(&t), way.prismatic, arm.length());
                doubtful += usize::from(!result.complete || result.crowded);
                noise += result.noise;
            }
            ways.push((doubtful, noise, way));
        }
    }
    ways.sort_by(|x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)));
    let first = ways[0].2;
    let other = ways.iter().find(|(doubtful, _, way)| way.order[2] != first.order[2] && 2 * *doubtful < poses);
    [first, other.unwrap_or(&ways[1]).2]
}

/// All solutions in the arm's order.
pub fn solve(plan: &Plan, arm: &Arm, t: &Frame) -> Branches<6, 16> {
    let mut result: Branches<6, 16> = Branches::new();
    let mut take = |found: &dyn Fn(usize) -> Option<Branch<6>>, miss, near, continuum| {
        for i in 0.. {
            let Some(branch) = found(i) else { break };
            result.add(branch);
        }
        (result.miss, result.near, result.continuum) = (miss, near, continuum);
    };
    match plan {
        Plan::SphericalTriple { way, regional } => {
            let links = way.links_at(t);
            let [p1, p2, p3, ..] = way.prismatic;
            let mut found = spherical_triple(&links, [p1, p2, p3], regional.block);
            let closing = Loop { links: &links, prismatic: way.prismatic, target: [0.0; 3], length: arm.length() };
            if regional.exact {
                close_where_solutions_meet(&mut found, &closing);
            } else {
                polish(&mut found, &closing);
            }
            take(&|i| found.found().get(i).map(|b| way.of_arm(b)), found.miss, found.near, found.continuum);
        }
        Plan::ThreeParallel { way, related } => {
            let links = way.links_at(t);
            let mut found = three_parallel(&links);
            let closing = Loop { links: &links, prismatic: way.prismatic, target: [0.0; 3], length: arm.length() };
            if *related {
                close_where_solutions_meet(&mut found, &closing);
            } else {
                polish(&mut found, &closing);
            }
            take(&|i| found.found().get(i).map(|b| way.of_arm(b)), found.miss, found.near, found.continuum);
        }
        Plan::ParallelTurns { way, regional } => {
            let links = way.links_at(t);
            let [p1, p2, p3, _] = way.prismatic;
            let found = parallel_turns(&links, [p1, p2, p3], regional.block);
            let pad = |b: &Branch<4>| {
                let b = way.of_arm(b);
                let [a, b1, c, d] = b.joints;
                Branch { joints: [a, b1, c, d, [1.0, 0.0], [1.0, 0.0]], signs: b.signs, double: b.double, error: b.error, free: b.free }
            };
            take(&|i| found.found().get(i).map(&pad), found.miss, found.near, found.continuum);
        }
        Plan::General { ways } => return general_arm(ways, t, arm.length()),
    }
    result
}
