// Coordinates of coupled joints.
//
// The variables of the joints are q = S p + c. A construction gives q; the coordinates are p = S⁻¹ (q - c). S and its inverse take whole turns to whole
// turns, so that angles of p may be brought to (-pi, pi] as those of q are.

/// Postures in joint variables as postures in coordinates, with angles in (-pi, pi]: p = `factors` q + `offset`. A coordinate is free where a joint
/// variable is free that it depends on. `prismatic`: the coordinates that slide.
pub fn in_coordinates<const JOINTS: usize, const MOST: usize>(
    found: &Postures<JOINTS, MOST>,
    factors: [[Real; JOINTS]; JOINTS],
    offset: [Real; JOINTS],
    prismatic: [bool; JOINTS],
) -> Postures<JOINTS, MOST> {
    let mut result = *found;
    for solution in result.all.iter_mut().take(found.count) {
        let variables = *solution;
        solution.q = sums_of(&variables.q, factors, offset);
        solution.free = 0;
        for (p, slides) in solution.q.iter_mut().zip(prismatic) {
            if !slides {
                *p += WHOLE_TURN * floor(0.5 - *p / WHOLE_TURN);
            }
        }
        for (a, row) in factors.iter().enumerate() {
            for (i, factor) in row.iter().enumerate() {
                if *factor != 0.0 {
                    solution.free |= (variables.free >> i & 1) << a;
                }
            }
        }
    }
    result
}

/// `factors` q + `offset`.
pub fn sums_of<const JOINTS: usize>(q: &[Real; JOINTS], factors: [[Real; JOINTS]; JOINTS], offset: [Real; JOINTS]) -> [Real; JOINTS] {
    let mut sums = offset;
    for (sum, row) in sums.iter_mut().zip(factors) {
        for (factor, q) in row.iter().zip(q) {
            *sum += factor * q;
        }
    }
    sums
}
