// A pose for an arm with fewer than six joints: virtual joints beyond the last one, which have to come out 0.
//
// Six rows for J < 6 joints are met at few poses. With virtual joints the arm has solutions at every pose near by, and those with the virtual
// joints at 0 are the arm's own. At a pose that it reaches two solutions of the completed arm may meet although its own joints are well
// determined by all rows; the completed arm then has these joints to the square root of rounding only. So a virtual joint is not judged:
// the arm's own joints are refined by the method of Gauss and Newton on all six rows, and what these leave over is judged.

/// How far all rows may stay from met, relative to the lengths in the loop, where the candidates come from the determinant: 1e-9 in double
/// precision. Of closed forms it is [`ROUNDING`].
pub const GENERAL_ROWS: Real = if UNIT_ROUNDOFF < 1e-10 { 1e-9 } else { ROUNDING };

/// A candidate that leaves more of the rows than this, relative to the arm's length, has not been moved there by rounding.
const FAR: Real = 0.25;

/// Of two that meet: so large an error, rad, that neither need be near the candidate; four times that, that they need not be to either side of it.
/// In double precision errors are smaller by orders.
const VAGUE: Real = 1.0 / 128.0;

/// The solutions of an arm of J joints, of those that the arm completed by virtual joints has at a pose, in the arm's order.
///
/// - `arm`: its loop from joint 1 on, with joints behind the last one that stay at 0. `found`: what a construction has found for the completed arm.
///   `length`: the arm's size, > 0. `tolerance`: of the rows, relative to all lengths in the loop.
/// - A joint that is free in the completed arm need not be in the arm: it is tried at four values, with another one that is free, or the last one.
/// - Where two solutions of the completed arm meet, as far as its blocks can tell, those of the arm are to both sides.
/// - `double`: the Jacobian of the arm's own joints is so nearly of lower rank that rounding of the pose decides. `free`: a joint can move while
///   the others keep all rows met. `near`: the construction may have missed something, no posture came of a candidate that stands for several, or
///   what is left of the rows is within a factor of two of what may be.
/// - None: `miss` is what the best candidate leaves of the rows, m, with angles times `length`, or by how much the construction missed.
pub fn without_virtual_joints<const V: usize, const J: usize, const N: usize>(
    arm: &Arrangement<6>,
    found: &Branches<V, N>,
    t: &Frame,
    length: Real,
    tolerance: Real,
) -> Branches<J, N> {
    let links = arm.links_at(t);
    let closing = Loop { links: &links, prismatic: arm.prismatic, target: [0.0; 3], length };
    let most = tolerance * links.iter().fold(length, |sum, link| sum + extent(link));
    let mut kept = Branches { miss: found.miss, ..Branches::new() };
    let mut lost = found.near || found.continuum;
    for branch in found.found() {
        let start = in_loop(arm, &branch.joints, J);
        let (_, first) = closing.equations(&start);
        // Of two that meet rounding may have moved the place by much.
        if branch.free == 0 && !branch.double && first > FAR * length {
            kept.missed(first);
            continue;
        }
        let turned = tried::<J>(branch.free, &arm.prismatic);
        let starts = if turned[0] == J { 1 } else { 17 };
        let mut best = Closed { joints: start, residual: Real::INFINITY, double: false };
        let mut met_all = false;
        for number in 0..starts {
            let mut joints = start;
            if number > 0 && turned[0] < J {
                joints[turned[0]] = QUARTERS[number % 4];
            }
            if number > 0 && turned[1] < J {
                joints[turned[1]] = QUARTERS[number / 4 % 4];
            }
            let met = settle::<J, N>(&mut kept, arm, &closing, &joints, branch.signs, most);
            met_all |= met.residual <= most;
            if met.residual < best.residual {
                best = met;
            }
        }
        let nearly = branch.double || branch.free != 0 || best.residual <= 64.0 * sqrt(UNIT_ROUNDOFF) * length;
        if best.residual > most && nearly {
            let from = best;
            // What is left grows with the square of the distance from there; so does the error that the candidate came with, if it is not vague.
            let error = branch.error.min(VAGUE * VAGUE);
            let by = sqrt(8.0 * (from.residual / length).max(error)).min(0.5);
            for number in 0..2 * J {
                let mut step = [0.0; 6];
                let joint = number / 2;
                let size = if arm.prismatic[joint] { by * length } else { by };
                step[joint] = if number % 2 == 0 { size } else { -size };
                let met = settle::<J, N>(&mut kept, arm, &closing, &closing.moved(&from.joints, &step), branch.signs, most);
                met_all |= met.residual <= most;
                if met.residual < best.residual {
                    best = met;
                }
            }
            // A continuum of the completed arm near the pose may have postures that no start has led to. Of two that meet the places are known to
            // the root of rounding, or of the candidate's error, and what is left between them is the square of that.
            let close = if branch.free != 0 { 64.0 * sqrt(UNIT_ROUNDOFF) } else { error.max(4096.0 * UNIT_ROUNDOFF) };
            lost |= !met_all && (branch.double && branch.error > VAGUE || from.residual <= close * length);
        }
        if branch.double && best.residual <= most {
            // The candidate stands for two, of which this is one.
            let before = kept.count;
            settle::<J, N>(&mut kept, arm, &closing, &mirrored(&start, &best.joints, &arm.prismatic), branch.signs, most);
            lost |= branch.error > 4.0 * VAGUE && kept.count == before;
        }
        lost |= !(best.residual < Real::INFINITY);
    }
    if kept.count == 0 && (lost || !(kept.miss < Real::INFINITY)) {
        // Nothing says how far the pose is, or what is near has been missed: from four postures.
        for first in 0..4 {
            let mut joints = in_loop(arm, &[[1.0, 0.0]; J], J);
            for (joint, value) in joints.iter_mut().zip(&posture(first, &arm.prismatic)).take(J) {
                *joint = *value;
            }
            settle::<J, N>(&mut kept, arm, &closing, &joints, 0, most);
        }
    }
    kept.near |= lost;
    kept
}

/// The first two turning joints of the arm that are free in the completed one; for the second, where there is but one, the last of the others. J: none.
fn tried<const J: usize>(free: u32, prismatic: &[bool; 6]) -> [usize; 2] {
    let mut turned = [J; 2];
    for joint in 0..J {
        if free >> joint & 1 == 1 && !prismatic[joint] {
            if turned[0] == J {
                turned[0] = joint;
            } else if turned[1] == J {
                turned[1] = joint;
            }
        }
    }
    if turned[0] < J && turned[1] == J {
        for joint in 0..J {
            if joint != turned[0] && !prismatic[joint] {
                turned[1] = joint;
            }
        }
    }
    turned
}

/// Refines a posture, and keeps what meets all rows.
fn settle<const J: usize, const N: usize>(
    kept: &mut Branches<J, N>,
    arm: &Arrangement<6>,
    closing: &Loop<6>,
    joints: &[[Real; 2]; 6],
    signs: u16,
    most: Real,
) -> Closed<6> {
    let met = refined::<J>(closing, joints, J);
    if met.residual <= most {
        let (_, first) = closing.equations(joints);
        keep::<J, N>(kept, arm, closing.length, &own::<J>(arm, closing, &met, most), signs, first);
    } else {
        kept.missed(met.residual);
    }
    // Rounding of the pose decides on which side of the tolerance it is.
    kept.near |= met.residual > 0.5 * most && met.residual <= 2.0 * most;
    met
}

/// A posture as far from the middle as another on the other side.
fn mirrored(middle: &[[Real; 2]; 6], other: &[[Real; 2]; 6], prismatic: &[bool; 6]) -> [[Real; 2]; 6] {
    let mut joints = *middle;
    for ((joint, [x, y]), slides) in joints.iter_mut().zip(other).zip(prismatic) {
        let [c, s] = *joint;
        // The point turned back from the other, and by its own angle.
        let [u, v] = [c * x + s * y, s * x - c * y];
        *joint = if *slides { [2.0 * c - x, 0.0] } else { back_on_circle([c * u - s * v, s * u + c * v]) };
    }
    joints
}

/// The values in the loop of an arm's first joints; the others are at 0.
fn in_loop<const V: usize>(arm: &Arrangement<6>, joints: &[[Real; 2]; V], own: usize) -> [[Real; 2]; 6] {
    let mut values = [[1.0, 0.0]; 6];
    for place in 0..6 {
        let ([c, s], slides) = (arm.offsets[place], arm.prismatic[place]);
        let [x, y] = if place < own && place < V {
            joints[place]
        } else if slides {
            [0.0, 0.0]
        } else {
            [1.0, 0.0]
        };
        values[place] = if slides { [x + c, 0.0] } else { [x * c - y * s, y * c + x * s] };
    }
    values
}

/// The equations of a step of the first J joints by least squares, (K'K) dq = K'e for the columns K of the Jacobian and what is left e of the rows;
/// steps of the others, and of the joint `held`, are 0. Damped by rounding (Levenberg), so that joints that move nothing stay where they are.
fn normal_equations<const J: usize>(closing: &Loop<6>, of: &Equations<6>, held: usize) -> Equations<6> {
    let moves = |i: usize| i < J && i != held;
    let mut own = *of;
    for row in &mut own.rows {
        for (i, entry) in row.iter_mut().enumerate() {
            *entry = if moves(i) { *entry } else { 0.0 };
        }
    }
    let mut normal = least_squares(&own);
    for i in 0..6 {
        let size = if closing.prismatic[i] { 1.0 } else { closing.length * closing.length };
        normal.rows[i][i] += if moves(i) { 16.0 * UNIT_ROUNDOFF * size } else { size };
    }
    normal
}

/// The method of Gauss and Newton from `joints` until what is left of the rows no longer falls. Towards a place where the Jacobian is of lower
/// rank a step halves the distance only.
fn refined<const J: usize>(closing: &Loop<6>, joints: &[[Real; 2]; 6], held: usize) -> Closed<6> {
    let mut best = Closed { joints: *joints, residual: Real::INFINITY, double: false };
    let mut joints = *joints;
    for step in 0..=40 {
        let (equations, residual) = closing.equations(&joints);
        let falls = residual < 0.5 * best.residual;
        if residual < best.residual {
            best = Closed { joints, residual, double: false };
        }
        let enough = residual <= 4.0 * UNIT_ROUNDOFF * closing.length || (!falls && (step > 4 || best.residual <= CLOSED * closing.length));
        if enough || !(residual < Real::INFINITY) {
            break;
        }
        let (x, _) = solve(&normal_equations::<J>(closing, &equations, held));
        joints = closing.moved(&joints, &x);
    }
    best
}

/// Whether |K⁺|² times the bound of second derivatives times 32 u is at least 1/2, with lengths in units of the arm's length: as
/// [`Loop::close`] judges six joints. |K⁺|² is the trace of (K'K)⁻¹.
fn is_nearly_double<const J: usize>(closing: &Loop<6>, joints: &[[Real; 2]; 6]) -> bool {
    const SECOND_DERIVATIVES: Real = 4.0;
    let (equations, _) = closing.equations(joints);
    let normal = normal_equations::<J>(closing, &equations, J);
    let mut trace: Real = 0.0;
    for k in 0..J {
        let mut unit = normal;
        unit.right = [0.0; 6];
        unit.right[k] = 1.0;
        let (x, pivot) = solve(&unit);
        let one = x[k].abs() * if closing.prismatic[k] { 1.0 } else { closing.length * closing.length };
        trace = if pivot > 0.0 { trace + one } else { Real::INFINITY };
    }
    !(trace * SECOND_DERIVATIVES * 32.0 * UNIT_ROUNDOFF < 0.5)
}

/// A posture with a free joint at 0: it goes there in steps, on which the others follow.
fn at_zero<const J: usize>(arm: &Arrangement<6>, closing: &Loop<6>, met: &Closed<6>, joint: usize) -> Closed<6> {
    let ([x, y], [c, s]) = (met.joints[joint], arm.offsets[joint]);
    let left = if closing.prismatic[joint] { c - x } else { atan2(x * s - y * c, x * c + y * s) };
    let mut joints = met.joints;
    for _ in 0..8 {
        let mut step = [0.0; 6];
        step[joint] = 0.125 * left;
        joints = refined::<J>(closing, &closing.moved(&joints, &step), joint).joints;
    }
    joints[joint] = [c, s];
    refined::<J>(closing, &joints, joint)
}

/// A posture that meets all rows as a solution of the arm. Where it is nearly double each joint is moved: if the others can follow, it is free,
/// and the first such joint is taken to 0 if they can follow there.
fn own<const J: usize>(arm: &Arrangement<6>, closing: &Loop<6>, met: &Closed<6>, most: Real) -> Branch<J> {
    let mut place = *met;
    let mut free = 0;
    let double = is_nearly_double::<J>(closing, &met.joints);
    if double {
        for joint in 0..J {
            let mut moves = false;
            for by in [0.25, -0.25, 0.02, -0.02] {
                let mut step = [0.0; 6];
                step[joint] = if closing.prismatic[joint] { by * closing.length } else { by };
                moves = moves || refined::<J>(closing, &closing.moved(&met.joints, &step), joint).residual <= most;
            }
            if moves {
                if free == 0 {
                    let there = at_zero::<J>(arm, closing, met, joint);
                    if there.residual <= most {
                        place = there;
                    }
                }
                free |= 1 << joint;
            }
        }
    }
    let whole = arm.of_arm(&Branch { joints: place.joints, signs: 0, double: double && free == 0, error: 0.0, free });
    let mut joints = [[1.0, 0.0]; J];
    for (own, value) in joints.iter_mut().zip(&whole.joints) {
        *own = *value;
    }
    Branch { joints, signs: 0, double: whole.double, error: 0.0, free: whole.free }
}

/// Adds a solution, unless it is known: then the way that came nearest gives it its name. `first`: how far from met the rows were.
fn keep<const J: usize, const N: usize>(
    kept: &mut Branches<J, N>,
    arm: &Arrangement<6>,
    length: Real,
    branch: &Branch<J>,
    signs: u16,
    first: Real,
) {
    let same = SAME * sqrt(UNIT_ROUNDOFF);
    let count = kept.count;
    for known in kept.all.iter_mut().take(count) {
        let wide = branch.double || known.double || branch.free != 0;
        let off = apart(&known.joints, &branch.joints, &arm.prismatic, length);
        if off <= if wide { 64.0 * same } else { same } {
            if first < known.error {
                (known.signs, known.error) = (signs, first);
            }
            known.double |= branch.double;
            known.free |= branch.free;
            return;
        }
    }
    kept.add(Branch { joints: branch.joints, signs, double: branch.double, error: first, free: branch.free });
}
