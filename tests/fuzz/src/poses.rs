//! Any numbers as an arm's links and a pose: every construction of inverse kinematics ends with solutions that are some, and a verdict that
//! fits them.

/// What an emitted module has around the blocks, for six joints of any kind.
#[allow(dead_code, missing_docs, clippy::all)]
mod solver {
    pub use armgen_inverse_kinematics::f64::*;

    pub const DOF: usize = 6;
    pub const MAX_SOLUTIONS: usize = 16;
    pub const PRISMATIC: [bool; DOF] = [false; DOF];
    pub const LENGTH: Real = 1.0;
    pub const POSITION_LIMITS: [[Real; 2]; DOF] = [[-3.0, 4.0]; DOF];

    pub type Solutions = Postures<DOF, MAX_SOLUTIONS>;

    /// With as many joints as the module has, the last ones at 0.
    fn padded<const J: usize>(found: &Branches<J, 8>) -> Branches<6, 8> {
        let mut all = Branches { miss: found.miss, near: found.near, continuum: found.continuum, ..Branches::new() };
        for branch in found.found() {
            let joints = std::array::from_fn(|i| branch.joints.get(i).copied().unwrap_or([1.0, 0.0]));
            all.add(Branch { joints, signs: branch.signs, double: branch.double, error: branch.error, free: branch.free });
        }
        all
    }

    /// The solutions of the construction of this number.
    pub fn solve(which: u8, links: &[Frame; 6], other: &[Frame; 6], length: Real, t: &[[Real; 4]; 4]) -> Solutions {
        if !is_pose(t) {
            return Solutions::none(Verdict::Invalid);
        }
        let [x, y, z, _] = *t;
        let t = [x, y, z];
        let way = |links: &[Frame; 6]| Arrangement {
            order: [0, 1, 2, 3, 4, 5],
            prismatic: [false; 6],
            links: *links,
            open: 5,
            before: IDENTITY,
            after: IDENTITY,
            backward: false,
            offsets: [[1.0, 0.0]; 6],
        };
        let (first, second) = (way(links), way(other));
        let regional = [regional_elbow, regional_crossing, regional_general];
        let found = match which % 8 {
            0 => conclude(&general_arm(&[first, second], &t, length), PRISMATIC, true),
            1 => conclude(&three_parallel(&first.links_at(&t)), PRISMATIC, false),
            2 => conclude(&three_prismatic(&first.links_at(&t), [0, 2, 4]), PRISMATIC, false),
            // Arms of three and five joints, completed to the one or the other.
            6 => conclude(
                &padded(&without_virtual_joints::<6, 3, 8>(
                    &second,
                    &three_prismatic(&first.links_at(&t), [0, 2, 4]),
                    &t,
                    length,
                    ROUNDING,
                )),
                PRISMATIC,
                false,
            ),
            7 => conclude(
                &padded(&without_virtual_joints::<6, 5, 8>(&second, &three_parallel(&first.links_at(&t)), &t, length, ROUNDING)),
                PRISMATIC,
                false,
            ),
            n => {
                let links = first.links_at(&t);
                let mut found = spherical_triple(&links, [false; 3], regional[usize::from(n) - 3]);
                polish(&mut found, &Loop { links: &links, prismatic: [false; 6], target: [0.0; 3], length });
                conclude(&found, PRISMATIC, false)
            }
        };
        found.of_rotation(&t)
    }
}

use solver::{solve, Solutions, Verdict, LENGTH, MAX_SOLUTIONS, POSITION_LIMITS, PRISMATIC};

/// The target.
///
/// # Panics
/// Where the reader is wrong.
pub fn run(data: &[u8]) {
    let Some((&which, rest)) = data.split_first() else { return };
    let mut bytes = rest.iter().copied();
    // Mostly small multiples of 1/64, so that axes meet and are parallel; any bits now and then.
    let mut number = move || {
        let mut next = || bytes.next().unwrap_or(0);
        match next() {
            255 => f64::from_bits(u64::from_le_bytes(std::array::from_fn(|_| next()))),
            254 => f64::from(next()) * 1e-9,
            small => f64::from(small as i8) / 64.0,
        }
    };
    // Rotations by angles, so that a frame is valid unless a number is NaN or infinite.
    let mut frame = || {
        let ((s, c), (t, d)) = (number().sin_cos(), number().sin_cos());
        [[c, -s * d, s * t, number()], [s, c * d, -c * t, number()], [0.0, t, d, number()]]
    };
    let (links, other) = (std::array::from_fn(|_| frame()), std::array::from_fn(|_| frame()));
    let [x, y, z] = frame();
    let found = solve(which, &links, &other, 1.0, &[x, y, z, [0.0, 0.0, 0.0, 1.0]]);
    check(&found);
    let within = found.within(POSITION_LIMITS, PRISMATIC, LENGTH);
    check_count(&within);
    assert!(within.count <= found.count && within.verdict == found.verdict);
    for solution in within.as_slice() {
        assert!(solution.q.iter().zip(POSITION_LIMITS).all(|(q, [low, high])| low <= *q && *q <= high), "{solution:?}");
    }
    assert_eq!(found.nearest(&[0.3; 6], PRISMATIC).is_some(), found.count > 0);
}

fn check_count(found: &Solutions) {
    assert!(found.count <= MAX_SOLUTIONS && found.as_slice().len() == found.count);
}

fn check(found: &Solutions) {
    check_count(found);
    for solution in found.as_slice() {
        let turn = std::f64::consts::PI;
        assert!(solution.q.iter().all(|q| -turn <= *q && *q <= turn), "{solution:?}");
        if found.verdict == Verdict::Complete {
            assert!(!solution.double && solution.free == 0, "{solution:?}");
        }
    }
    match found.verdict {
        Verdict::Complete => assert!(found.count > 0),
        Verdict::Unreachable | Verdict::Invalid => assert!(found.count == 0),
        Verdict::NearDouble | Verdict::Continuum => {}
    }
    assert!(found.miss >= 0.0 && (found.miss == 0.0 || found.verdict == Verdict::Unreachable));
}
