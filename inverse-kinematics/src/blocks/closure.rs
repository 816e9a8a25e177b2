// Newton's method on a closed loop of six joints, or on the position that three joints reach: the last digits of a solution, its residual, and
// how well it is determined.

/// How far from closed a loop may stay that counts as closed, relative to the arm's length: 1e-13 in double precision.
/// Six frames in a row come to about 50 u.
pub const CLOSED: Real = 1024.0 * UNIT_ROUNDOFF;

/// The same where solutions meet, and in any case at the end of slides that go far: 7e-12 in double precision. In single precision the root of
/// rounding bounds it.
const CLOSED_AT_MOST: Real = if UNIT_ROUNDOFF < 1e-10 { 64.0 } else { 32.0 } * CLOSED;

/// How far a loop may stay open that is not closed once more where solutions meet: next to what six frames come to.
const NEXT_TO_ROUNDING: Real = 0.125 * CLOSED;

/// What N joints have to meet, in as many equations: six close a loop, J1 L1 ... J6 L6 = 1; three bring the origin of J1 L1 J2 L2 J3 L3 to a point.
#[derive(Clone, Copy, Debug)]
pub struct Loop<'a, const N: usize> {
    /// L1 to LN.
    pub links: &'a [Frame; N],
    /// The kinds of the joints.
    pub prismatic: [bool; N],
    /// Where the origin is to go: 0 if a loop is to be closed.
    pub target: Vector,
    /// A length of the arm's size, > 0: an angle of 1 rad counts as much as this length.
    pub length: Real,
}

/// What [`Loop::close`] reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closed<const N: usize> {
    /// The joints' values.
    pub joints: [[Real; 2]; N],
    /// The largest component of displacement and turn (times the length) by which the equations are missed; the displacement of an arm with slides
    /// in units of its reach.
    pub residual: Real,
    /// They are met at a place where their Jacobian is so nearly singular that rounding of the pose decides between two solutions and none.
    pub double: bool,
}

/// N linear equations.
#[derive(Clone, Copy, Debug)]
struct Equations<const N: usize> {
    rows: [[Real; N]; N],
    right: [Real; N],
}

impl<const N: usize> Loop<'_, N> {
    /// The equations of one step, J dq = -residual, and the residual: columns (z × (t - p), z) of axes z through p.
    fn equations(&self, joints: &[[Real; 2]; N]) -> (Equations<N>, Real) {
        let mut chain = IDENTITY;
        let mut axes = [([0.0; 3], [0.0; 3]); N];
        for (((axis, value), link), prismatic) in axes.iter_mut().zip(joints).zip(self.links).zip(self.prismatic) {
            *axis = (column(&chain, 2), column(&chain, 3));
            chain = compose(&chain, &joint_then(prismatic, *value, link));
        }
        let t = column(&chain, 3);
        let mut of = Equations { rows: [[0.0; N]; N], right: [0.0; N] };
        let mut residual: Real = 0.0;
        for k in 0..3 {
            of.right[k] = self.target[k] - t[k];
            residual = residual.max(of.right[k].abs());
        }
        if self.slides_far() {
            residual /= self.extended(joints);
        }
        if N > 3 {
            let turn = turn_vector_of(&chain);
            for k in 0..3 {
                of.right[k + 3] = -self.length * turn[k];
                residual = residual.max(of.right[k + 3].abs());
            }
        }
        for (i, ((z, p), prismatic)) in axes.iter().zip(self.prismatic).enumerate() {
            let linear = if prismatic { *z } else { cross(*z, minus(t, *p)) };
            for k in 0..3 {
                of.rows[k][i] = linear[k];
                if N > 3 {
                    of.rows[k + 3][i] = if prismatic { 0.0 } else { self.length * z[k] };
                }
            }
        }
        (of, residual)
    }

    /// The values after a step, each at most half a radian or half the length.
    fn moved(&self, joints: &[[Real; 2]; N], step: &[Real; N]) -> [[Real; 2]; N] {
        let mut moved = *joints;
        for ((value, step), prismatic) in moved.iter_mut().zip(step).zip(self.prismatic) {
            let [c, s] = *value;
            *value = if prismatic {
                [c + step.max(-0.5 * self.length).min(0.5 * self.length), 0.0]
            } else {
                let (cd, sd) = small_turn(step.clamp(-0.5, 0.5));
                back_on_circle([c * cd - s * sd, s * cd + c * sd])
            };
        }
        moved
    }

    /// Newton's method from `joints` until the residual no longer falls, at most 6 steps. At a `contact`, where two solutions may have met, 12, since
    /// it only halves the distance there; and as that place is found to the root of its residual only, a larger rounding is asked for in `double`.
    /// NaN: a residual that is not small.
    pub fn close(&self, joints: &[[Real; 2]; N], contact: bool) -> Closed<N> {
        let (steps, units) = if contact { (12, 1024.0) } else { (6, 32.0) };
        let mut best = Closed { joints: *joints, residual: Real::INFINITY, double: false };
        let mut joints = *joints;
        for step in 0..=steps {
            let (equations, residual) = self.equations(&joints);
            let falls = residual < 0.5 * best.residual;
            let (x, pivot) = solve(&equations);
            if residual < best.residual {
                // Only a small pivot lets the Jacobian be nearly singular: the inverse is worth its time there.
                let double = !(pivot > 1e-3 * self.length) && self.nearly_double(&equations, &joints, units);
                best = Closed { joints, residual, double };
            }
            let precise = residual <= 16.0 * UNIT_ROUNDOFF * self.length;
            if precise || step == steps || (!falls && best.residual <= CLOSED * self.length) || !(residual < Real::INFINITY) {
                break;
            }
            joints = self.moved(&joints, &x);
        }
        best
    }

    /// [`Loop::close`] from `joints`, which leave `residual`, or from beside them by the angle whose square that is; after it steps that need no
    /// regular Jacobian, and once more. Where a joint is `free` (bit i) but for the rounding that is left, only some of its values close the loop:
    /// last it is turned by half a radian.
    fn close_beside(&self, joints: &[[Real; 2]; N], residual: Real, free: u32) -> Closed<N> {
        let by = sqrt(residual / self.length).min(0.25);
        let mut best = Closed { joints: *joints, residual: Real::INFINITY, double: false };
        for (side, turn) in [(0.0, 0.0), (by, 0.0), (-by, 0.0), (0.0, 0.5), (0.0, -0.5)] {
            if free == 0 && turn != 0.0 {
                break;
            }
            let mut step = [0.0; N];
            for (i, (step, prismatic)) in step.iter_mut().zip(self.prismatic).enumerate() {
                let unit = if prismatic { self.length } else { 1.0 };
                *step = unit * if free >> i & 1 == 1 { side + turn } else { side };
            }
            let mut start = self.moved(joints, &step);
            for again in [true, false] {
                let closed = self.close(&start, true);
                if closed.residual < best.residual {
                    best = closed;
                }
                if best.residual <= NEXT_TO_ROUNDING * self.length {
                    return best;
                }
                if again {
                    start = self.nearest(&start, 1e-6).joints;
                }
            }
        }
        best
    }

    /// Whether |J⁻¹|² K `units` u >= 1/2 with lengths in units of the arm's length: what Newton and Kantorovich's theorem asks for to hold one
    /// solution apart from another after a change of the pose by its rounding. K, the bound of second derivatives, is taken as 4:
    /// lever arms of two lengths of the arm. Slides that become parallel go to infinity and come back from the other side: extended to r lengths,
    /// at an angle of 1/r, |J⁻¹| has a factor r² from that pole, which is no second solution.
    fn nearly_double(&self, equations: &Equations<N>, joints: &[[Real; 2]; N], units: Real) -> bool {
        const SECOND_DERIVATIVES: Real = 4.0;
        let pole = if self.slides_far() { self.extended(joints).min(self.steepness(equations)) } else { 1.0 };
        let pole = pole * pole;
        let mut square = 0.0;
        for k in 0..N {
            let mut unit = *equations;
            unit.right = [0.0; N];
            unit.right[k] = self.length;
            let (column, _) = solve(&unit);
            for (x, prismatic) in column.iter().zip(self.prismatic) {
                let x = if prismatic { *x / self.length } else { *x };
                square += x * x;
            }
        }
        !(square / (pole * pole) * SECOND_DERIVATIVES * units * UNIT_ROUNDOFF < 0.5)
    }

    /// One over the least sine between directions of slides, 1 at least.
    fn steepness(&self, equations: &Equations<N>) -> Real {
        let direction = |i: usize| {
            let mut z = [0.0; 3];
            for (z, row) in z.iter_mut().zip(&equations.rows) {
                *z = row.get(i).copied().unwrap_or(0.0);
            }
            z
        };
        let mut least: Real = 1.0;
        for i in 0..N {
            for j in 0..i {
                if self.prismatic[i] && self.prismatic[j] {
                    let normal = cross(direction(i), direction(j));
                    least = least.min(dot(normal, normal));
                }
            }
        }
        1.0 / sqrt(least)
    }

    /// Whether slides may take parts of the arm far from where the loop is closed.
    fn slides_far(&self) -> bool {
        N > 3 && self.prismatic.iter().any(|slides| *slides)
    }

    /// How far the arm reaches with its slides, in units of its length: displacements are right to so many roundings, and a turn moves the end
    /// effector by as much.
    fn extended(&self, joints: &[[Real; 2]; N]) -> Real {
        let mut furthest: Real = 0.0;
        for (value, prismatic) in joints.iter().zip(self.prismatic) {
            furthest = furthest.max(if prismatic { value[0].abs() } else { 0.0 });
        }
        1.0 + furthest / self.length
    }

    /// By how much the end effector misses its place: the residual and its own rounding, as far as slides take them.
    fn miss(&self, closed: &Closed<N>) -> Real {
        let reach = if self.slides_far() { self.extended(&closed.joints) } else { 1.0 };
        (closed.residual + UNIT_ROUNDOFF * self.length) * reach
    }

    /// Whether the loop is closed there: to some roundings of its reach, and where solutions meet (`contact`) to the root of rounding. Not where
    /// slides go so far that their rounding alone is more.
    fn is_closed(&self, closed: &Closed<N>, contact: bool) -> bool {
        (contact || closed.residual <= CLOSED * self.length) && self.miss(closed) <= CLOSED_AT_MOST * self.length
    }

    /// The least residual that damped steps (Levenberg, Marquardt) reach from `joints` in 30 of them: how far a pose out of reach is. `damping`, of
    /// the squared length, is divided by 4 by each that succeeds. `double`: the Jacobian is singular there, to the root of a larger rounding,
    /// since such a place is found to the root of its residual only.
    pub fn nearest(&self, joints: &[[Real; 2]; N], damping: Real) -> Closed<N> {
        let mut joints = *joints;
        let (mut here, mut residual) = self.equations(&joints);
        let square = |equations: &Equations<N>| equations.right.iter().fold(0.0, |sum, e| sum + e * e);
        let mut damping = damping * self.length * self.length;
        for _ in 0..30 {
            // (J'J + damping) dq = J' e
            let mut normal = least_squares(&here);
            for i in 0..N {
                normal.rows[i][i] += damping;
            }
            let (x, _) = solve(&normal);
            let next = self.moved(&joints, &x);
            let (there, left) = self.equations(&next);
            if square(&there) < square(&here) {
                (joints, here, residual) = (next, there, left);
                damping *= 0.25;
            } else {
                damping *= 4.0;
            }
        }
        Closed { joints, residual, double: self.nearly_double(&here, &joints, 1024.0) }
    }
}

/// Brings every solution to the last digits: for constructions that lose some on the way (block R with D = 2). Solutions with a
/// joint that is free stay as they are. One that cannot be closed is none, and says `near`: it has been found for rounding alone.
/// So does a position's whose Jacobian is nearly singular. That of a loop also is where two turns of a wrist meet, which blocks tell apart.
/// Where there is none and no block says by how much it missed, `miss` is the least residual of [`Loop::nearest`] from four postures; one that closes
/// the loop all the same says `near`.
pub fn polish<const J: usize, const N: usize>(found: &mut Branches<J, N>, closing: &Loop<J>) {
    let mut kept = Branches { all: found.all, ..Branches::new() };
    (kept.miss, kept.near, kept.continuum) = (found.miss, found.near, found.continuum);
    for branch in found.found() {
        let mut branch = *branch;
        if branch.free == 0 {
            let closed = closing.close(&branch.joints, branch.double);
            if !closing.is_closed(&closed, branch.double) {
                kept.near = true;
                continue;
            }
            branch.joints = closed.joints;
            if J == 3 && closed.double {
                kept.near = true;
                branch.double = true;
            }
            if is_known(&mut kept, &branch, closing) {
                continue;
            }
        }
        if !(branch.double && is_among(kept.found(), &branch, closing)) {
            kept.add(branch);
        }
    }
    if kept.count == 0 && !kept.near && !kept.continuum && !(kept.miss < Real::INFINITY) {
        for first in 0..4 {
            let nearest = closing.nearest(&posture(first, &closing.prismatic), 1.0);
            kept.near |= nearest.residual <= CLOSED * closing.length;
            kept.missed(nearest.residual);
        }
    }
    *found = kept;
}

/// Brings solutions of closed forms to the pose where several meet. There a block may know its angle to the root of rounding only, and what is
/// computed from that angle misses the pose by as much. Only solutions that are `double` or have a joint that is free are looked at, and those that
/// close the loop stay as they are. The others are brought there by `close_beside`; one that cannot be is none, and says `near`. Where that leaves
/// none the one that came nearest is given, as `double`, if it misses by the root of rounding at most.
pub fn close_where_solutions_meet<const J: usize, const N: usize>(found: &mut Branches<J, N>, closing: &Loop<J>) {
    let mut meet = false;
    for branch in found.found() {
        meet |= branch.double || branch.free != 0;
    }
    if meet {
        close_those_that_meet(found, closing);
    }
}

/// The same where there are such solutions.
#[cold]
#[inline(never)]
fn close_those_that_meet<const J: usize, const N: usize>(found: &mut Branches<J, N>, closing: &Loop<J>) {
    let mut kept = Branches { all: found.all, ..Branches::new() };
    (kept.miss, kept.near, kept.continuum) = (found.miss, found.near, found.continuum);
    let (mut nearest, mut least) = (Branch { joints: [[1.0, 0.0]; J], signs: 0, double: true, error: 0.0, free: 0 }, Real::INFINITY);
    for branch in found.found() {
        let mut branch = *branch;
        if branch.double || branch.free != 0 {
            let (_, residual) = closing.equations(&branch.joints);
            let here = Closed { joints: branch.joints, residual, double: true };
            if !(residual <= NEXT_TO_ROUNDING * closing.length && closing.is_closed(&here, false)) {
                let best = closing.close_beside(&branch.joints, residual, branch.free);
                if !closing.is_closed(&best, false) {
                    kept.near = true;
                    if closing.miss(&best) < least {
                        least = closing.miss(&best);
                        nearest = branch;
                        nearest.joints = best.joints;
                    }
                    continue;
                }
                branch.joints = best.joints;
                if branch.free == 0 && is_among(kept.found(), &branch, closing) {
                    continue;
                }
            }
        }
        kept.add(branch);
    }
    if kept.count == 0 && least <= SAME * sqrt(UNIT_ROUNDOFF) * closing.length {
        nearest.double = true;
        kept.add(nearest);
    }
    *found = kept;
}

/// Quarter turns: values at which a turning joint is tried.
const QUARTERS: [[Real; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];

/// One of four postures to search from, with all slides at 0.
fn posture<const J: usize>(number: usize, prismatic: &[bool; J]) -> [[Real; 2]; J] {
    let mut joints = [[0.0; 2]; J];
    for (i, (joint, prismatic)) in joints.iter_mut().zip(prismatic).enumerate() {
        *joint = if *prismatic { [0.0; 2] } else { QUARTERS[(number + i * i) % 4] };
    }
    joints
}

/// Whether two ways have led to one solution: rounding has parted a double root. It is double then.
fn is_known<const J: usize, const N: usize>(kept: &mut Branches<J, N>, branch: &Branch<J>, closing: &Loop<J>) -> bool {
    let count = kept.count;
    for known in kept.all.iter_mut().take(count) {
        let off = apart(&known.joints, &branch.joints, &closing.prismatic, closing.length);
        if known.free == 0 && off <= SAME * sqrt(UNIT_ROUNDOFF) {
            known.double = true;
            return true;
        }
    }
    false
}

/// Whether one of some solutions is the other of two that meet, as far as rounding lets one tell. Both are double then.
fn is_among<const J: usize>(known: &[Branch<J>], branch: &Branch<J>, closing: &Loop<J>) -> bool {
    let same = 64.0 * SAME * sqrt(UNIT_ROUNDOFF);
    for known in known {
        if known.double && apart(&known.joints, &branch.joints, &closing.prismatic, closing.length) <= same {
            return true;
        }
    }
    false
}

/// The displacement of the origin to a point: the last link of a loop that brings that point to its target.
#[inline]
pub fn displaced([x, y, z]: Vector) -> Frame {
    [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]]
}

/// The same displacement with the rotation (3 - R R')/2 R: a rotation to e² where R is one to e.
fn orthonormal(link: &Frame) -> Frame {
    let mut result = *link;
    for i in 0..3 {
        for j in 0..3 {
            let [x, y, z, _] = link[j];
            let wanted = if i == j { 1.0 } else { 0.0 };
            let off = 0.5 * (wanted - dot([link[i][0], link[i][1], link[i][2]], [x, y, z]));
            result[i][0] += off * x;
            result[i][1] += off * y;
            result[i][2] += off * z;
        }
    }
    result
}

/// The turn of a frame: sine times axis for less than a right angle, beyond that angle times axis; about x for a half turn.
fn turn_vector_of(f: &Frame) -> Vector {
    let v = [0.5 * (f[2][1] - f[1][2]), 0.5 * (f[0][2] - f[2][0]), 0.5 * (f[1][0] - f[0][1])];
    let cosine = 0.5 * (f[0][0] + f[1][1] + f[2][2] - 1.0);
    if cosine > 0.0 {
        return v;
    }
    let sine = sqrt(dot(v, v));
    let angle = atan2(sine, cosine);
    if sine > 0.0 {
        v.map(|x| x * angle / sine)
    } else {
        [angle, 0.0, 0.0]
    }
}

/// The solution by elimination with row pivots, and the smallest pivot; components whose pivot vanishes are 0.
fn solve<const N: usize>(equations: &Equations<N>) -> ([Real; N], Real) {
    let Equations { mut rows, mut right } = *equations;
    let mut smallest = Real::INFINITY;
    for k in 0..N {
        let mut pivot = k;
        for i in k + 1..N {
            if rows[i][k].abs() > rows[pivot][k].abs() {
                pivot = i;
            }
        }
        if pivot > k && pivot < N {
            rows.swap(k, pivot);
            right.swap(k, pivot);
        }
        let (row, e) = (rows[k], right[k]);
        smallest = smallest.min(row[k].abs());
        let over = if row[k] != 0.0 { 1.0 / row[k] } else { 0.0 };
        for (below, left) in rows.iter_mut().zip(&mut right).skip(k + 1) {
            let factor = below[k] * over;
            for j in k + 1..N {
                below[j] -= factor * row[j];
            }
            *left -= factor * e;
        }
    }
    let mut x = [0.0; N];
    for k in (0..N).rev() {
        let mut sum = right[k];
        for j in k + 1..N {
            sum -= rows[k][j] * x[j];
        }
        x[k] = if rows[k][k] != 0.0 { sum / rows[k][k] } else { 0.0 };
    }
    (x, smallest)
}

/// The equations of least squares, (K'K) x = K'e for the rows (K, e).
fn least_squares<const N: usize>(of: &Equations<N>) -> Equations<N> {
    let mut normal = Equations { rows: [[0.0; N]; N], right: [0.0; N] };
    for i in 0..N {
        for j in 0..N {
            normal.rows[i][j] = of.rows.iter().fold(0.0, |sum, row| sum + row[i] * row[j]);
        }
        normal.right[i] = of.rows.iter().zip(of.right).fold(0.0, |sum, (row, e)| sum + row[i] * e);
    }
    normal
}

/// Two solutions that are no further apart than this times the root of u are one: 8e-8 in double precision.
const SAME: Real = 8.0;

/// Solutions that are no further apart than this times [`SAME`] times the root of u meet there.
const MEET: Real = 8.0;

/// How far two solutions are apart: the most by which the two values of a joint differ, slides in units of `length`.
fn apart<const J: usize, const K: usize>(x: &[[Real; 2]; J], y: &[[Real; 2]; J], prismatic: &[bool; K], length: Real) -> Real {
    let mut largest: Real = 0.0;
    for ((x, y), slides) in x.iter().zip(y).zip(prismatic) {
        let unit = if *slides { length } else { 1.0 };
        largest = largest.max(((x[0] - y[0]).abs() + (x[1] - y[1]).abs()) / unit);
    }
    largest
}

/// By how much a loop is moved to find solutions that are hidden at special poses: rad and lengths of the arm. Above the root of rounding, to which
/// meeting roots are known; small enough for Newton's method to come back.
const BESIDE: Real = if UNIT_ROUNDOFF < 1e-10 { 1e-5 } else { 4e-3 };

/// The same the other way, further.
const FURTHER_BESIDE: Real = if UNIT_ROUNDOFF < 1e-10 { -3e-4 } else { -1e-2 };

/// The same beside a crowd of roots, either way.
const BESIDE_CROWD: Real = if UNIT_ROUNDOFF < 1e-10 { 3e-3 } else { 3e-2 };
const FURTHER_BESIDE_CROWD: Real = if UNIT_ROUNDOFF < 1e-10 { -2e-2 } else { -6e-2 };

/// A displacement by about as much, in no particular direction.
fn moved_by(x: Real) -> Frame {
    let (ca, sa) = small_turn(0.7 * x);
    let (cb, sb) = small_turn(x);
    let a = [[ca, -sa, 0.0, 0.9 * x], [sa, ca, 0.0, -0.5 * x], [0.0, 0.0, 1.0, 0.6 * x]];
    let b = [[cb, 0.0, sb, 0.0], [0.0, 1.0, 0.0, 0.0], [-sb, 0.0, cb, 0.0]];
    compose(&a, &compose(&b, &[[1.0, 0.0, 0.0, 0.0], [0.0, ca, -sa, 0.0], [0.0, sa, ca, 0.0]]))
}

/// What Newton's method finds from a solution of a loop beside, or damped steps where the place is singular.
fn close_from_beside(closing: &Loop<6>, joints: &[[Real; 2]; 6]) -> Closed<6> {
    let closed = closing.close(joints, false);
    if closing.is_closed(&closed, false) {
        closed
    } else {
        closing.nearest(joints, UNIT_ROUNDOFF)
    }
}

/// Adds a solution unless it is known. Two that are apart by a few roots of rounding meet there: both are double.
fn merge<const N: usize>(found: &mut Branches<6, N>, closing: &Loop<6>, closed: &Closed<6>, double: bool) {
    let same = SAME * sqrt(UNIT_ROUNDOFF);
    let double = closed.double || double;
    let (count, mut meets) = (found.count, false);
    for known in found.all.iter_mut().take(count) {
        let off = apart(&known.joints, &closed.joints, &closing.prismatic, closing.length);
        // The place of a double solution is known to the root of the rounding only.
        if off <= if double || known.double { 64.0 * same } else { same } {
            known.double |= double;
            return;
        }
        if off <= MEET * same {
            (known.double, meets) = (true, true);
        }
    }
    found.add(Branch { joints: closed.joints, signs: 0, double: double || meets, error: 0.0, free: 0 });
}
