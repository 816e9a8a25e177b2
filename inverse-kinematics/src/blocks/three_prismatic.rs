// Six joints, three of them prismatic.

/// Three prismatic and three revolute joints: J1 L1 ... J6 L6 = 1. `turning` are the numbers (from 0) of the revolute joints.
///
/// Rotations do not feel the prismatic joints: with A and B what stands between the revolute joints as rotations, and C what is left to
/// close the loop, Rz A Rz B Rz = C⁻¹ is block 5; A and B are Rx(alpha), Rx(beta). The lengths are then the solution of three linear equations.
///
/// - At most 2 solutions; `signs`: bit 0, the sign of the second revolute joint's sine.
/// - The first and the third axis parallel: both free together. Sliding directions that are in one plane at the angles found, to rounding: the
///   prismatic joints free together if the point is in that plane, else none.
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
    let noise = ROUNDING * links.iter().fold(0.0, |sum, f| sum + extent(f));
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
        // The chain's displacement is undone by the slides: Cramer's rule.
        let [x, y, z] = directions;
        let t = [-chain[0][3], -chain[1][3], -chain[2][3]];
        let determinant = dot(x, cross(y, z));
        let mut lengths = [0.0; 3];
        let mut free = if turns.free { 1 << r1 | 1 << r3 } else { 0 };
        if determinant.abs() > ROUNDING {
            lengths = [dot(t, cross(y, z)), dot(x, cross(t, z)), dot(x, cross(y, t))].map(|d| d / determinant);
        } else {
            let normals = [cross(x, y), cross(y, z), cross(z, x)];
            let off = normals.iter().fold(0.0, |off: Real, n| off.max(dot(*n, t).abs()));
            if !(off <= noise) {
                found.missed(off);
                continue;
            }
            // One of the slides can be 0; the pair that spans the plane best does it.
            let square = |i: usize| normals.get(i).map_or(0.0, |n| dot(*n, *n));
            let (u, v, n) = if square(0) >= square(1) && square(0) >= square(2) {
                (0, 1, normals[0])
            } else if square(1) >= square(2) {
                (1, 2, normals[1])
            } else {
                (2, 0, normals[2])
            };
            let at = |i: usize| directions.get(i).copied().unwrap_or([0.0; 3]);
            let over = 1.0 / dot(n, n);
            for (i, value) in [(u, dot(n, cross(t, at(v))) * over), (v, dot(n, cross(at(u), t)) * over)] {
                if let Some(length) = lengths.get_mut(i) {
                    *length = value;
                }
            }
            free |= 0b111111 & !(1 << r1 | 1 << r2 | 1 << r3);
        }
        let mut lengths = lengths.iter();
        for (i, joint) in joints.iter_mut().enumerate() {
            if i != r1 && i != r2 && i != r3 {
                *joint = [lengths.next().copied().unwrap_or(0.0), 0.0];
            }
        }
        found.add(Branch { joints, signs: number as u16, double: turns.double, error: 0.0, free });
    }
    found
}
