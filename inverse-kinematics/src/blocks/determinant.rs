// Block 8: six joints of a general arm, by a determinant that is sampled on the circle of one joint (`Eliminants` says of what).

/// What one arrangement of the loop says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arranged {
    /// The solutions, in the order of the roots of q3.
    pub found: Branches<6, 16>,
    /// How many roots the determinant has; a double one counts once.
    pub roots: usize,
    /// The largest of the orders above the degree, of 1: how much rounding there is in the determinant.
    pub noise: Real,
    /// Each root led to one solution, nothing is near, and the noise is small: the solutions are all.
    pub complete: bool,
    /// The determinant vanishes identically.
    pub free: bool,
}

/// The values of the determinant at 24 equal angles of a circle, and the largest of them.
fn sampled(eliminants: &Eliminants, spread: &Spread) -> ([Real; 24], Real) {
    let mut samples = [0.0; 24];
    let mut largest: Real = 0.0;
    for (group, samples) in samples.chunks_exact_mut(8).enumerate() {
        let (mut points, mut factors) = ([[0.0; 2]; 8], [0.0; 8]);
        for (j, (point, factor)) in points.iter_mut().zip(&mut factors).enumerate() {
            let j = 8 * group + j;
            (*point, *factor) = spread.at([cosine_of_15_degrees(j), cosine_of_15_degrees(j + 18)]);
        }
        let values = determinants(&eliminants.at(&points));
        for ((sample, value), factor) in samples.iter_mut().zip(values).zip(factors) {
            *sample = value * factor;
            largest = largest.max(sample.abs());
        }
    }
    (samples, largest)
}

/// The roots of a determinant on the circle of q3, and what becomes of them.
struct Search<'a> {
    eliminants: &'a Eliminants,
    spread: Spread,
    closing: Loop<'a, 6>,
}

impl Search<'_> {
    /// Block R on the determinant, whose values are divided by `largest`.
    fn roots(&self, a: &[Real; 9], b: &[Real; 9], noise: Real, largest: Real) -> CircleRoots<20> {
        let over = 1.0 / largest;
        circle_roots(a, b, (4.0 * noise).max(24.0 * UNIT_ROUNDOFF), 0.0, |points| {
            let (mut at, mut factors) = ([[0.0; 2]; 9], [0.0; 9]);
            for i in 0..9 {
                (at[i], factors[i]) = self.spread.at(points[i]);
            }
            let mut values = determinants(&self.eliminants.at(&at));
            for i in 0..9 {
                values[i] *= factors[i] * over;
            }
            values
        })
    }

    /// q3 at a point of the circle, and the kernel of M there.
    fn kernel_at(&self, point: [Real; 2], pair: bool) -> ([Real; 2], [[Real; 6]; 2], usize) {
        let (q3, _) = self.spread.at(point);
        let (vectors, count) = kernel(&reduced(&self.eliminants.at(&[q3])).0, pair);
        (q3, vectors, count)
    }

    /// All joints from q3 and a vector of the kernel, and by how much they leave the equations unmet.
    fn joints(&self, q3: [Real; 2], vector: &[Real; 6]) -> ([[Real; 2]; 6], Real) {
        self.eliminants.joints(self.closing.links, &self.closing.prismatic, 1.0, q3, vector)
    }

    /// Adds the solutions at the roots. Returns whether as many of them are new as there are roots, one that stands for two counted twice. Roots that
    /// are none of the arm are believed only where none stands for two.
    fn solve(&self, roots: &CircleRoots<20>, found: &mut Branches<6, 16>) -> bool {
        let (mut wanted, mut none, mut settled) = (0, 0, true);
        let (mut told, mut pairs) = (0, 0);
        for root in roots.all.iter().take(roots.count) {
            let before = found.count;
            if root.double && self.solve_pair(root, found) {
                wanted += 2;
                pairs += 1;
            } else {
                settled &= !root.double;
                wanted += 1;
                none += self.solve_root(root, found);
            }
            told += found.count - before;
        }
        settled && told + none == wanted && (none == 0 || pairs == 0)
    }

    /// Adds the two solutions that share a root, if there are two.
    fn solve_pair(&self, root: &CircleRoot, found: &mut Branches<6, 16>) -> bool {
        let (q3, vectors, kernels) = self.kernel_at([root.c, root.s], true);
        let (vectors, count) = products_in_pencil(&vectors);
        // With less than full rank each may stand for two itself.
        if kernels < 2 || count < 2 || self.eliminants.rank < 8 {
            return false;
        }
        let [one, other, ..] = vectors;
        let one = self.closing.close(&self.joints(q3, &one).0, false);
        let other = self.closing.close(&self.joints(q3, &other).0, false);
        let both = self.closing.is_closed(&one, false) && self.closing.is_closed(&other, false) && !one.double && !other.double;
        if both && apart(&one.joints, &other.joints, &self.closing.prismatic, 1.0) > 64.0 * SAME * sqrt(UNIT_ROUNDOFF) {
            merge(found, &self.closing, &one, false);
            merge(found, &self.closing, &other, false);
            return true;
        }
        false
    }

    /// Adds the solution at a root, or those that share it. Returns how many of them are none of the arm.
    fn solve_root(&self, root: &CircleRoot, found: &mut Branches<6, 16>) -> usize {
        let mut none = 0;
        let (q3, mut vectors, mut count) = self.kernel_at([root.c, root.s], false);
        if count == 2 {
            (vectors, count) = products_in_pencil(&vectors);
        }
        for vector in vectors.iter().take(count) {
            let (joints, unmet) = self.joints(q3, vector);
            if unmet > UNMET {
                none += 1;
                continue;
            }
            let closed = self.closing.close(&joints, root.double);
            if self.closing.is_closed(&closed, root.double) {
                merge(found, &self.closing, &closed, closed.residual > CLOSED);
            }
        }
        none
    }

    /// Adds a double solution at each minimum that is nearly a root, if there is one: as near as rounding of the pose, it may have been at this
    /// place. Returns whether at each there is.
    fn solve_shallow(&self, roots: &CircleRoots<20>, found: &mut Branches<6, 16>) -> bool {
        let mut all = true;
        for place in roots.shallow.iter().take(roots.shallow_count) {
            let (q3, vectors, _) = self.kernel_at([place.c, place.s], false);
            let closed = self.closing.nearest(&self.joints(q3, &vectors[0]).0, UNIT_ROUNDOFF);
            // The search may have gone to another posture nearby.
            let met = closed.residual <= 2.0 * ROUNDING && closed.double;
            if met {
                merge(found, &self.closing, &closed, true);
            }
            all &= met;
        }
        all
    }

    /// The residual of a least-squares posture, from the angle at which the determinant is least.
    fn least_residual(&self, samples: &[Real; 24]) -> Real {
        let (mut place, mut least) = (0, Real::INFINITY);
        for (j, sample) in samples.iter().enumerate() {
            if sample.abs() < least {
                (place, least) = (j, sample.abs());
            }
        }
        let (q3, vectors, _) = self.kernel_at([cosine_of_15_degrees(place), cosine_of_15_degrees(place + 18)], false);
        self.closing.nearest(&self.joints(q3, &vectors[0]).0, 1e-2).residual
    }
}

/// Block 8, the determinant on a circle: J1 L1 J2 L2 J3 L3 J4 L4 J5 L5 J6 L6 = 1, joints 3 and 6 revolute, of the others at most one prismatic,
/// or both 1 and 2.
///
/// The determinant at 24 equal angles q3, by reflections (Householder) side by side; its Fourier orders 0 to 8 are the polynomial, 9 to 12 its
/// rounding. Where one of the values is weak the roots crowd there, and the circle is sampled again, `Spread`. Block R gives q3; the kernel of M q4 and q5, a two-dimensional one both of its products; the eliminated rows q1 and q2;
/// what is left q6. Newton's method closes the loop; equal solutions are merged.
///
/// - `links`: L1 to L6, one of them with the pose. `length`: the arm's own, > 0; the block works in units of it.
/// - `miss`, without solutions: the residual of a least-squares posture (the links' unit, angles times `length`).
/// - `double` is a solution at which the Jacobian is singular to rounding; a double root need not be one: solutions may share q3.
/// - `complete` is false where the count of solutions is not that of the roots, or something is near: another arrangement may know more.
/// - A determinant that vanishes at this pose, all angles q3: `free`; the joints can move while the loop stays closed, or the arrangement is one
///   that does not serve here. No solutions then.
/// - Arrangements exist for which the determinant vanishes for all poses, or has double roots at all poses: the choice is made when the arm is known.
pub fn determinant_on_circle(links: &[Frame; 6], prismatic: [bool; 6], length: Real) -> Arranged {
    let over = 1.0 / length;
    let mut unit = *links;
    for row in unit.iter_mut().flatten() {
        row[3] *= over;
    }
    let eliminants = Eliminants::new(&unit, &prismatic, 1.0);
    let mut spread = Spread::none();
    let (mut samples, mut largest) = sampled(&eliminants, &spread);
    let mut result = Arranged { found: Branches::new(), roots: 0, noise: 1.0, complete: false, free: false };
    // Each of 12 pivots of equations of norm 1 is at most that; below u^3 nothing is left.
    if !(largest > UNIT_ROUNDOFF * UNIT_ROUNDOFF * UNIT_ROUNDOFF) {
        result.free = largest <= UNIT_ROUNDOFF;
        return result;
    }
    let weak = sqrt(UNIT_ROUNDOFF) * largest;
    if samples.iter().any(|sample| sample.abs() < weak) {
        spread = Spread::of_roots(&samples);
        (samples, largest) = sampled(&eliminants, &spread);
    }
    let (a, b, noise) = fourier::<24, 9>(&samples, largest);
    result.noise = noise;
    let search = Search { eliminants: &eliminants, spread, closing: Loop { links: &unit, prismatic, target: [0.0; 3], length: 1.0 } };
    let roots = search.roots(&a, &b, noise, largest);
    result.roots = roots.count;
    result.free = roots.free || noise > NOTHING_BUT_NOISE;
    if result.free {
        return result;
    }
    let told = search.solve(&roots, &mut result.found);
    let shallow_met = search.solve_shallow(&roots, &mut result.found);
    result.complete = noise <= MOST_NOISE && told && !roots.ended && shallow_met;
    result.found.near = !result.complete;
    if result.found.count == 0 {
        result.found.missed(search.least_residual(&samples));
    }
    for branch in &mut result.found.all {
        for (value, prismatic) in branch.joints.iter_mut().zip(prismatic) {
            if prismatic {
                value[0] *= length;
            }
        }
    }
    result.found.miss *= length;
    result
}

/// More rounding than this in the determinant calls for another arrangement. Random poses stay below a hundredth of it; where roots crowd so that
/// several look like one, or like none, the noise is ten times as much and more.
const MOST_NOISE: Real = 1e4 * UNIT_ROUNDOFF;

/// A root that leaves an equation of norm 1 unmet by more than this is none of the arm: u^(1/4), since a root near a double one is right to
/// sqrt(u), and its kernel loses another half of that.
const UNMET: Real = if UNIT_ROUNDOFF < 1e-10 { 1e-4 } else { 1.5e-2 };

/// As much says that the determinant is nothing but rounding: it vanishes.
const NOTHING_BUT_NOISE: Real = 0.03;
