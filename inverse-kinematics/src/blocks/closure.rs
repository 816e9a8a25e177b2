// Newton's method on a closed loop of six joints: the last digits of a solution, its residual, and how well it is determined.

/// How far from closed a loop may stay that counts as closed, relative to the arm's length: 1e-13 in double precision.
/// Six frames in a row come to about 50 u.
pub const CLOSED: Real = 1024.0 * UNIT_ROUNDOFF;

/// A loop J1 L1 ... J6 L6 = 1 that is to be closed.
#[derive(Clone, Copy, Debug)]
pub struct Loop<'a> {
    /// L1 to L6.
    pub links: &'a [Frame; 6],
    /// The kinds of the joints.
    pub prismatic: [bool; 6],
    /// A length of the arm's size, > 0: an angle of 1 rad counts as much as this length.
    pub length: Real,
}

/// What [`Loop::close`] reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closed {
    /// The joints' values.
    pub joints: [[Real; 2]; 6],
    /// The largest component of displacement and turn (times the length) by which the loop stays open.
    pub residual: Real,
    /// The loop is closed at a place where its Jacobian is so nearly singular that rounding of the pose decides between two solutions and none.
    pub double: bool,
}

/// Six linear equations and their right side.
type Equations = [[Real; 7]; 6];

impl Loop<'_> {
    /// The equations of one step, J dq = -residual, and the residual: columns (z × (t - p), z) of axes z through p.
    fn equations(&self, joints: &[[Real; 2]; 6]) -> (Equations, Real) {
        let mut chain = IDENTITY;
        let mut axes = [([0.0; 3], [0.0; 3]); 6];
        for (((axis, value), link), prismatic) in axes.iter_mut().zip(joints).zip(self.links).zip(self.prismatic) {
            *axis = (column(&chain, 2), column(&chain, 3));
            chain = compose(&chain, &joint_then(prismatic, *value, link));
        }
        let t = column(&chain, 3);
        let turn = turn_vector_of(&chain);
        let mut rows = [[0.0; 7]; 6];
        let mut residual: Real = 0.0;
        for k in 0..3 {
            rows[k][6] = -t[k];
            rows[k + 3][6] = -self.length * turn[k];
            residual = residual.max(t[k].abs()).max(self.length * turn[k].abs());
        }
        for (i, ((z, p), prismatic)) in axes.iter().zip(self.prismatic).enumerate() {
            let linear = if prismatic { *z } else { cross(*z, minus(t, *p)) };
            for k in 0..3 {
                rows[k][i] = linear[k];
                rows[k + 3][i] = if prismatic { 0.0 } else { self.length * z[k] };
            }
        }
        (rows, residual)
    }

    /// The values after a step, each at most half a radian or half the length.
    fn moved(&self, joints: &[[Real; 2]; 6], step: &[Real; 6]) -> [[Real; 2]; 6] {
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
    pub fn close(&self, joints: &[[Real; 2]; 6], contact: bool) -> Closed {
        let (steps, units) = if contact { (12, 1024.0) } else { (6, 32.0) };
        let mut best = Closed { joints: *joints, residual: Real::INFINITY, double: false };
        let mut joints = *joints;
        for step in 0..=steps {
            let (rows, residual) = self.equations(&joints);
            let falls = residual < 0.5 * best.residual;
            let (x, pivot) = solve(&rows);
            if residual < best.residual {
                // Only a small pivot lets the Jacobian be nearly singular: the inverse is worth its time there.
                let double = !(pivot > 1e-3 * self.length) && self.nearly_double(&rows, units);
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

    /// Whether |J⁻¹|² K `units` u >= 1/2 with lengths in units of the arm's length: what Newton and Kantorovich's theorem asks for to hold one
    /// solution apart from another after a change of the pose by its rounding. K, the bound of second derivatives, is taken as 4:
    /// lever arms of two lengths of the arm.
    fn nearly_double(&self, rows: &Equations, units: Real) -> bool {
        const SECOND_DERIVATIVES: Real = 4.0;
        let mut square = 0.0;
        for k in 0..6 {
            let mut unit = *rows;
            for (i, row) in unit.iter_mut().enumerate() {
                row[6] = if i == k { self.length } else { 0.0 };
            }
            let (x, _) = solve(&unit);
            for (x, prismatic) in x.iter().zip(self.prismatic) {
                let x = if prismatic { x / self.length } else { *x };
                square += x * x;
            }
        }
        !(square * SECOND_DERIVATIVES * units * UNIT_ROUNDOFF < 0.5)
    }

    /// The least residual that damped steps (Levenberg, Marquardt) reach from `joints` in 30 of them: how far a pose out of reach is. `damping`, of
    /// the squared length, is divided by 4 by each that succeeds. `double`: the Jacobian is singular there, to the root of a larger rounding,
    /// since such a place is found to the root of its residual only.
    pub fn nearest(&self, joints: &[[Real; 2]; 6], damping: Real) -> Closed {
        let mut joints = *joints;
        let (mut rows, mut residual) = self.equations(&joints);
        let square = |rows: &Equations| rows.iter().fold(0.0, |sum, row| sum + row[6] * row[6]);
        let mut damping = damping * self.length * self.length;
        for _ in 0..30 {
            // (J'J + damping) dq = J' e
            let mut normal = [[0.0; 7]; 6];
            for i in 0..6 {
                for j in 0..7 {
                    normal[i][j] = rows.iter().fold(0.0, |sum, row| sum + row[i] * row[j]);
                }
                normal[i][i] += damping;
            }
            let (x, _) = solve(&normal);
            let next = self.moved(&joints, &x);
            let (there, left) = self.equations(&next);
            if square(&there) < square(&rows) {
                (joints, rows, residual) = (next, there, left);
                damping *= 0.25;
            } else {
                damping *= 4.0;
            }
        }
        Closed { joints, residual, double: self.nearly_double(&rows, 1024.0) }
    }
}

/// Closes every solution of a loop to the last digits: for constructions that lose some on the way (block R with D = 2). Solutions with a
/// joint that is free stay as they are. One that cannot be closed is none, and says `near`: it has been found for rounding alone.
/// Where there is none and no block says by how much it missed, `miss` is the least residual of [`Loop::nearest`] from four postures; one that closes
/// the loop all the same says `near`.
pub fn polish<const N: usize>(found: &mut Branches<6, N>, closing: &Loop) {
    let mut kept = Branches { all: found.all, ..Branches::new() };
    (kept.miss, kept.near, kept.continuum) = (found.miss, found.near, found.continuum);
    for branch in found.found() {
        let mut branch = *branch;
        if branch.free == 0 {
            let closed = closing.close(&branch.joints, branch.double);
            if closed.residual > if branch.double { 64.0 } else { 1.0 } * CLOSED * closing.length {
                kept.near = true;
                continue;
            }
            branch.joints = closed.joints;
        }
        kept.add(branch);
    }
    if kept.count == 0 && !kept.near && !kept.continuum && !(kept.miss < Real::INFINITY) {
        const STARTS: [[Real; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        for first in 0..4 {
            let mut joints = [[0.0; 2]; 6];
            for (i, (joint, prismatic)) in joints.iter_mut().zip(closing.prismatic).enumerate() {
                *joint = if prismatic { [0.0; 2] } else { STARTS[(first + i * i) % 4] };
            }
            let nearest = closing.nearest(&joints, 1.0);
            kept.near |= nearest.residual <= CLOSED * closing.length;
            kept.missed(nearest.residual);
        }
    }
    *found = kept;
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
fn solve(equations: &Equations) -> ([Real; 6], Real) {
    let mut rows = *equations;
    let mut smallest = Real::INFINITY;
    for k in 0..6 {
        let mut pivot = k;
        for i in k + 1..6 {
            if rows[i][k].abs() > rows[pivot][k].abs() {
                pivot = i;
            }
        }
        if pivot > k && pivot < 6 {
            rows.swap(k, pivot);
        }
        let row = rows[k];
        smallest = smallest.min(row[k].abs());
        let over = if row[k] != 0.0 { 1.0 / row[k] } else { 0.0 };
        for below in rows.iter_mut().skip(k + 1) {
            let factor = below[k] * over;
            for j in k + 1..7 {
                below[j] -= factor * row[j];
            }
        }
    }
    let mut x = [0.0; 6];
    for k in (0..6).rev() {
        let mut sum = rows[k][6];
        for j in k + 1..6 {
            sum -= rows[k][j] * x[j];
        }
        x[k] = if rows[k][k] != 0.0 { sum / rows[k][k] } else { 0.0 };
    }
    (x, smallest)
}

/// Two solutions whose joints differ by less than this are one: 8e-8 in double precision.
const SAME: Real = 8.0;

/// Adds a solution unless it is known.
fn merge<const N: usize>(found: &mut Branches<6, N>, closed: &Closed, double: bool) {
    let same = SAME * sqrt(UNIT_ROUNDOFF);
    let count = found.count;
    for known in found.all.iter_mut().take(count) {
        let mut apart: Real = 0.0;
        for (x, y) in known.joints.iter().zip(&closed.joints) {
            apart = apart.max((x[0] - y[0]).abs() + (x[1] - y[1]).abs());
        }
        // The place of a double solution is known to the root of the rounding only.
        let double = closed.double || double;
        if apart <= if double || known.double { 64.0 * same } else { same } {
            known.double |= double;
            return;
        }
    }
    found.add(Branch { joints: closed.joints, signs: 0, double: closed.double || double, error: 0.0, free: 0 });
}
