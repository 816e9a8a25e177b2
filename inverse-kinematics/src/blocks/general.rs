// Six joints of a general arm: two arrangements of the determinant on a circle, and where both may have missed something, poses beside.

/// All solutions of a general arm, in the arm's order: [`determinant_on_circle`] in the first arrangement; where that is not certain to be complete
/// also in the second, and both results are joined. Where that is not certain either, solutions come from [`poses_beside`].
///
/// - `near`: nothing is certain to be complete, or the ways contradict each other: solutions may be missing, or meet.
/// - `continuum`: the determinant vanishes in both.
pub fn general_arm(arrangements: &[Arrangement<6>; 2], t: &Frame, length: Real) -> Branches<6, 16> {
    let [first, second] = arrangements;
    let mut found = Branches::new();
    let one = determinant_on_circle(&first.links_at(t), first.prismatic, length);
    for branch in one.found.found() {
        join(&mut found, first, branch, length);
    }
    found.miss = one.found.miss;
    if one.complete && !one.crowded {
        return found;
    }
    let other = determinant_on_circle(&second.links_at(t), second.prismatic, length);
    for branch in other.found.found() {
        join(&mut found, second, branch, length);
    }
    found.miss = found.miss.min(other.found.miss);
    found.continuum = one.free && other.free;
    // Either the second is sure of itself and knows all that the first has found, or both found the same, an even number, double ones aside.
    let single = found.found().iter().filter(|branch| !branch.double).count();
    let agreed = one.found.count == found.count && other.found.count == found.count && single % 2 == 0;
    let clear = !one.free && !other.free && !one.crowded && !other.crowded;
    let settled = other.complete && !other.crowded && other.found.count == found.count || agreed && clear;
    // Solutions that share a root in one arrangement do not share it in one that leaves another joint for last.
    let apart = first.order[2] != second.order[2] && other.complete && other.found.count == found.count;
    if settled || apart && agreed && one.complete && found.count > 0 {
        return found;
    }
    let solve = |links: &[Frame; 6]| {
        let there = determinant_on_circle(links, first.prismatic, length);
        Branches { near: !there.complete, ..there.found }
    };
    let links = first.links_at(t);
    let (beside, counts) = poses_beside(&Loop { links: &links, prismatic: first.prismatic, target: [0.0; 3], length }, first.open, solve);
    for branch in beside.found() {
        join(&mut found, first, branch, length);
    }
    // What the second arrangement is sure of is believed if the poses beside find no more.
    found.near = !(apart && other.found.count == found.count) && !are_all(&beside, &counts, found.count);
    found
}

/// Adds a solution of an arrangement's loop, in the arm's order, unless it is known.
fn join(found: &mut Branches<6, 16>, way: &Arrangement<6>, branch: &Branch<6>, length: Real) {
    let same = SAME * sqrt(UNIT_ROUNDOFF);
    let branch = way.of_arm(branch);
    let mut prismatic = [false; 6];
    for (joint, slides) in way.order.iter().zip(way.prismatic) {
        if let Some(kind) = prismatic.get_mut(*joint) {
            *kind = slides;
        }
    }
    let count = found.count;
    for known in found.all.iter_mut().take(count) {
        // Of a double solution the place is known to the square root of the rounding only.
        let off = apart(&known.joints, &branch.joints, &prismatic, length);
        if off <= if known.double && branch.double { 64.0 * same } else { same } {
            known.double |= branch.double;
            return;
        }
    }
    found.add(branch);
}
