// Six joints of a general arm: two arrangements of the determinant on a circle.

/// All solutions of a general arm, in the arm's order: [`determinant_on_circle`] in the first arrangement; where that is not certain to be complete
/// also in the second, and both results are joined.
///
/// - The pose is made orthonormal first: where it is off by e, the two arrangements have solutions that are e over the smallest singular value apart.
/// - `near`: neither arrangement is complete, or they contradict each other: solutions may be missing.
/// - `continuum`: the determinant vanishes in both.
pub fn general_arm(arrangements: &[Arrangement<6>; 2], t: &Frame, length: Real) -> Branches<6, 16> {
    let [first, second] = arrangements;
    let t = &orthonormal(t);
    let mut found = Branches::new();
    let one = determinant_on_circle(&first.links_at(t), first.prismatic, length);
    for branch in one.found.found() {
        join(&mut found, first, branch, length);
    }
    found.miss = one.found.miss;
    if one.complete && found.count > 0 {
        return found;
    }
    let other = determinant_on_circle(&second.links_at(t), second.prismatic, length);
    for branch in other.found.found() {
        join(&mut found, second, branch, length);
    }
    found.miss = found.miss.min(other.found.miss);
    found.continuum = one.free && other.free;
    // The second is sure of itself and knows all that the first has found, or both found the same, an even number, double ones aside. Where rounding
    // hides roots it may hide them from both.
    let single = found.found().iter().filter(|branch| !branch.double).count();
    let quiet = one.noise <= MOST_NOISE && other.noise <= MOST_NOISE;
    let agreed = quiet && one.found.count == found.count && other.found.count == found.count && single % 2 == 0;
    let settled = one.complete || other.complete && other.found.count == found.count || agreed && !one.free && !other.free;
    found.near = !settled || found.miss <= CLOSED_AT_MOST * length;
    add_from_beside(&mut found, first, t, length, !quiet);
    found
}

/// Adds what closes the loop from the solutions at poses beside it. Where solutions share a root of the determinant, though they are regular,
/// beside it each has a root of its own. `crowded`: rounding hides roots over more than that.
#[cold]
#[inline(never)]
fn add_from_beside(found: &mut Branches<6, 16>, way: &Arrangement<6>, t: &Frame, length: Real, crowded: bool) {
    let links = way.links_at(t);
    let closing = Loop { links: &links, prismatic: way.prismatic, target: [0.0; 3], length };
    for by in [BESIDE, FURTHER_BESIDE, BESIDE_CROWD, FURTHER_BESIDE_CROWD] {
        if by.abs() > FURTHER_BESIDE.abs() && !crowded {
            continue;
        }
        let mut moved = moved_by(by);
        for row in &mut moved {
            row[3] *= length;
        }
        let beside = determinant_on_circle(&way.links_at(&compose(t, &moved)), way.prismatic, length);
        for branch in beside.found.found() {
            let closed = close_from_beside(&closing, &branch.joints);
            if closing.is_closed(&closed, false) {
                let known = found.count;
                let mut other = *branch;
                (other.joints, other.double) = (closed.joints, closed.double);
                join(found, way, &other, length);
                found.near |= found.count > known;
            }
        }
    }
}

/// Adds a solution of an arrangement's loop, in the arm's order, unless it is known. Two that are apart by a few roots of rounding meet there: both
/// are double.
fn join(found: &mut Branches<6, 16>, way: &Arrangement<6>, branch: &Branch<6>, length: Real) {
    let same = SAME * sqrt(UNIT_ROUNDOFF);
    let mut branch = way.of_arm(branch);
    let mut prismatic = [false; 6];
    for (joint, slides) in way.order.iter().zip(way.prismatic) {
        if let Some(kind) = prismatic.get_mut(*joint) {
            *kind = slides;
        }
    }
    let (count, mut meets) = (found.count, false);
    for known in found.all.iter_mut().take(count) {
        // Of a double solution the place is known to the square root of the rounding only.
        let off = apart(&known.joints, &branch.joints, &prismatic, length);
        if off <= if known.double && branch.double { 64.0 * same } else { same } {
            known.double |= branch.double;
            return;
        }
        if off <= MEET * same {
            (known.double, meets) = (true, true);
        }
    }
    branch.double |= meets;
    found.add(branch);
}
