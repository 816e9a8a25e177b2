// Six joints, three of them prismatic.

/// Three prismatic and three revolute joints: J1 L1 ... J6 L6 = 1. `turning` are the numbers (from 0) of the revolute joints.
///
/// Rotations do not feel the prismatic joints: with A and B what stands between the revolute joints as rotations, and C what is left to
/// close the loop, Rz A Rz B Rz = C⁻¹ is block 5; A and B are Rx(alpha), Rx(beta). The lengths are then the solution of three linear equations.
///
/// - At most 2 solutions; `signs`: bit 0, the sign of the second revolute joint's sine.
/// - The first and the third axis parallel: both free together. Sliding directions that are in one plane at the angles found, to what is known of
///   them: the prismatic joints free together if the point is in that plane, else none. It may be where the first and the third are free.
/// - Solutions that meet, or have a free joint, are right to the root of rounding: [`close_where_solutions_meet`] brings them to the pose.
pub fn three_prismatic(links: &[Frame; 6], turning: [usize; 3]) -> Branches<6, 8> {
    let mut found = Branches::new();
    let [r1, r2, r3] = turning;
    // The rotations after each revolute joint up to the next; what stands before the first closes the loop.
    let mut parts = [IDENTITY; 4];
    let mut part = 0;
    for (i, link) in links.iter().enumerate() {
        part += usize::from(i == r1 || i == r2 || i == r3);
        if let Some(between) = parts.get_mut(part) {
            *between = compose(between, link);
        }
    }
    let [before, a, b, after] = parts;
    let rest = inverse(&compose(&after, &before));
    let turns = three_turns(&rest, [a[2][2], a[2][1]], [b[2][2], b[2][1]], ROUNDING, 0.0);
    found.missed(turns.miss);
    let lengths_of_links = links.iter().fold(0.0, |sum, f| sum + extent(f));
    let noise = ROUNDING * lengths_of_links;
    // How far directions may be off: t2 is known to rounding over its sine, to the root of rounding where two turns meet; t1 and t3 to rounding over
    // the sine between axes 1 and 3.
    let root = 8.0 * sqrt(ROUNDING);
    let by_turns = ROUNDING / (length(rest[0][2], rest[1][2]) + ROUNDING);
    let by_middle = 8.0 * ROUNDING / (turns.turns[0][1][1].abs() + sqrt(ROUNDING));
    let doubt = if turns.free { 0.0 } else { by_turns + by_middle };
    for (number, turn) in turns.turns.iter().enumerate().take(turns.count) {
        let mut joints = [[0.0, 0.0]; 6];
        let mut directions = [[0.0; 3]; 3];
        let mut chain = IDENTITY;
        let (mut turned, mut slid) = (0, 0);
        for (i, (joint, link)) in joints.iter_mut().zip(links).enumerate() {
            if i == r1 || i == r2 || i == r3 {
                *joint = turn.get(turned).copied().unwrap_or([1.0, 0.0]);
                turned += 1;
                chain = compose(&chain, &joint_then(false, *joint, link));
            } else {
                if let Some(direction) = directions.get_mut(slid) {
                    *direction = column(&chain, 2);
                }
                slid += 1;
                chain = compose(&chain, link);
            }
        }
        // The chain's displacement is undone by the slides: by one of them what is across the plane of the two that span theirs best, by these
        // the rest. So the point is met even where all directions are nearly in one plane.
        let [x, y, z] = directions;
        let t = [-chain[0][3], -chain[1][3], -chain[2][3]];
        let normals = [cross(y, z), cross(z, x), cross(x, y)];
        let square = |i: usize| normals.get(i).map_or(0.0, |n| dot(*n, *n));
        let (across, u, v) = if square(2) >= square(0) && square(2) >= square(1) {
            (2, 0, 1)
        } else if square(0) >= square(1) {
            (0, 1, 2)
        } else {
            (1, 2, 0)
        };
        let at = |of: &[Vector; 3], i: usize| of.get(i).copied().unwrap_or([0.0; 3]);
        let (n, w) = (at(&normals, across), at(&directions, across));
        let (determinant, off) = (dot(n, w), dot(n, t));
        let turns_bits = 1 << r1 | 1 << r3;
        let mut free = if turns.free { turns_bits } else { 0 };
        let mut across_by = 0.0;
        let is_in_plane = turns.free || off.abs() <= noise + doubt * lengths_of_links;
        if determinant.abs() <= ROUNDING + doubt && is_in_plane {
            free |= 0b111111 & !(1 << r1 | 1 << r2 | 1 << r3);
            if doubt > root {
                free |= turns_bits;
            }
        } else if determinant.abs() > ROUNDING {
            across_by = off / determinant;
        } else {
            found.missed(off.abs());
            continue;
        }
        let rest = [t[0] - across_by * w[0], t[1] - across_by * w[1], t[2] - across_by * w[2]];
        let square = dot(n, n);
        let over = if square > 0.0 { 1.0 / square } else { 0.0 };
        let mut lengths = [0.0; 3];
        let of_pair = (dot(n, cross(rest, at(&directions, v))) * over, dot(n, cross(at(&directions, u), rest)) * over);
        for (i, value) in [(across, across_by), (u, of_pair.0), (v, of_pair.1)] {
            if let Some(length) = lengths.get_mut(i) {
                *length = value;
            }
        }
        let mut lengths = lengths.iter();
        for (i, joint) in joints.iter_mut().enumerate() {
            if i != r1 && i != r2 && i != r3 {
                *joint = [lengths.next().copied().unwrap_or(0.0), 0.0];
            }
        }
        let double = turns.double || determinant.abs() <= root;
        found.add(Branch { joints, signs: number as u16, double, error: doubt, free });
    }
    found
}
