// Block 9: six joints, two of them prismatic, by samples of a product.
//
// With one revolute joint given, the other three make a rotation, block 5: t2's sine is ±w, w² = W. The prismatic joints can then close the loop
// if what is left to slide is in the plane of their directions: f = det(na, nb, r) = 0. f is A + B w in the ring of numbers a + b w, w² = W, whatever
// the sign of W; the product of both branches, A² - B² W, times the squared sine h² between axes t1 and t3 (the denominator of t1 and t3) is a
// trigonometric polynomial of degree 4 in the given joint: at most 8 solutions. Found by sampling for every place of the two joints.
//
// Slides on both sides of a revolute joint, both at right angles to its axis k, have na × nb = k sin(t): f has a factor that vanishes where the slides
// are parallel, without a posture there. nb is replaced by k × na, which leaves that factor out.

/// a + b w.
#[derive(Clone, Copy)]
struct WithRoot {
    a: Real,
    b: Real,
}

impl WithRoot {
    fn plus(self, y: WithRoot) -> WithRoot {
        WithRoot { a: self.a + y.a, b: self.b + y.b }
    }

    fn minus(self, y: WithRoot) -> WithRoot {
        WithRoot { a: self.a - y.a, b: self.b - y.b }
    }

    fn by(self, k: Real) -> WithRoot {
        WithRoot { a: k * self.a, b: k * self.b }
    }

    /// The product, w² = `square`.
    fn times(self, y: WithRoot, square: Real) -> WithRoot {
        WithRoot { a: self.a * y.a + self.b * y.b * square, b: self.a * y.b + self.b * y.a }
    }

    /// The value for a real w.
    fn at(self, w: Real) -> Real {
        self.a + self.b * w
    }
}

/// A loop with two prismatic joints; the first joint is revolute, and is the one that is given.
struct TwoSlides<'a> {
    links: &'a [Frame; 6],
    slides: [usize; 2],
    /// The place of the revolute joint between the slides, both at right angles to its axis; 6 if there is none.
    across: usize,
    /// k × na there.
    beside: [WithRoot; 3],
    /// (cos, sin) of alpha and beta, and the rotations before t1 and after t3.
    alpha: [Real; 2],
    beta: [Real; 2],
    before: Frame,
    after: Frame,
}

/// The loop at one value of the given joint.
struct AtGiven {
    /// (cos, sin) of t1, t2, t3 as a + b w.
    turns: [[WithRoot; 2]; 3],
    /// w².
    square: Real,
    /// h²: (sin between axes t1 and t3)².
    sine: Real,
    /// det(na, nb, r).
    f: WithRoot,
}

impl<'a> TwoSlides<'a> {
    fn new(links: &'a [Frame; 6], slides: [usize; 2]) -> Self {
        let mut parts = [IDENTITY; 4];
        let mut part = 0;
        for (i, link) in links.iter().enumerate() {
            part += usize::from(i > 0 && !slides.contains(&i));
            if let Some(between) = parts.get_mut(part) {
                *between = compose(between, link);
            }
        }
        let [before, a, b, after] = parts;
        let [s, t] = slides;
        // The axes of neighbours are at a right angle.
        let right = |place: usize| links.get(place).map_or(1.0, |link| link[2][2].abs()) == 0.0;
        let (mut across, mut na) = (6, [0.0; 3]);
        if s + 2 == t && right(s) && right(s + 1) {
            across = s + 1;
            na = links.get(s).map_or([0.0; 3], |link| [link[2][0], link[2][1], link[2][2]]);
        } else if s == 1 && t == 5 && right(0) && right(5) {
            across = 0;
            na = column(&links[0], 2);
        }
        let beside = [WithRoot { a: -na[1], b: 0.0 }, WithRoot { a: na[0], b: 0.0 }, WithRoot { a: 0.0, b: 0.0 }];
        TwoSlides { links, slides, across, beside, alpha: [a[2][2], a[2][1]], beta: [b[2][2], b[2][1]], before, after }
    }

    /// Whether axes t1 and t3 are parallel at some angle of the first joint, to the fourth root of u: the product has a double root there.
    fn axes_meet(&self) -> bool {
        let [x, y, _] = self.before;
        let axis = self.after[2];
        let most = (axis[2] * self.before[2][2]).abs() + length(axis[0], axis[1]) * length(x[2], y[2]);
        1.0 - most <= sqrt(UNIT_ROUNDOFF)
    }

    /// What is left to slide, and the directions of the slides, as they are seen from behind the first joint. `apart`: k × na for nb, if there is
    /// such a joint.
    fn displacements(&self, turns: &[[WithRoot; 2]; 3], square: Real, apart: bool) -> [[WithRoot; 3]; 3] {
        const ZERO: WithRoot = WithRoot { a: 0.0, b: 0.0 };
        let mut vectors = [[ZERO; 3]; 3];
        let mut turns = turns.iter().rev();
        let mut slid = 0;
        for (i, link) in self.links.iter().enumerate().rev() {
            for (k, vector) in vectors.iter_mut().enumerate() {
                let [x, y, z] = *vector;
                let row = |r: &[Real; 4]| {
                    let turned = x.by(r[0]).plus(y.by(r[1])).plus(z.by(r[2]));
                    if k == 0 {
                        WithRoot { a: turned.a + r[3], ..turned }
                    } else {
                        turned
                    }
                };
                *vector = [row(&link[0]), row(&link[1]), row(&link[2])];
            }
            if i == 0 {
                break;
            }
            if self.slides.contains(&i) {
                slid += 1;
                // From the last on: direction 2, then 1.
                if let Some(direction) = vectors.get_mut(if slid == 1 { 2 } else { 1 }) {
                    *direction = [ZERO, ZERO, WithRoot { a: 1.0, b: 0.0 }];
                }
            } else if let Some([c, s]) = turns.next() {
                for vector in &mut vectors {
                    let [x, y, z] = *vector;
                    *vector = [
                        c.times(x, square).minus(s.times(y, square)),
                        s.times(x, square).plus(c.times(y, square)),
                        z,
                    ];
                }
                if apart && i == self.across {
                    vectors[2] = self.beside;
                }
            }
        }
        if apart && self.across == 0 {
            vectors[2] = self.beside;
        }
        vectors
    }

    fn at(&self, given: [Real; 2]) -> AtGiven {
        let ([ca, sa], [cb, sb]) = (self.alpha, self.beta);
        // Rz(t1) A Rz(t2) B Rz(t3) = (after J1 before)⁻¹
        let g = inverse(&compose(&self.after, &joint_then(false, given, &self.before)));
        let c2 = (ca * cb - g[2][2]) / (sa * sb);
        let square = (1.0 - c2) * (1.0 + c2);
        let sine = g[0][2] * g[0][2] + g[1][2] * g[1][2];
        let over = 1.0 / (sine + Real::MIN_POSITIVE);
        // Third column and third row, as in block 5.
        let (x, y) = (WithRoot { a: 0.0, b: sb }, WithRoot { a: -(ca * c2 * sb + sa * cb), b: 0.0 });
        let (u, v) = (WithRoot { a: 0.0, b: sa }, WithRoot { a: sa * c2 * cb + ca * sb, b: 0.0 });
        let t1 = [x.by(g[0][2]).plus(y.by(g[1][2])).by(over), x.by(g[1][2]).minus(y.by(g[0][2])).by(over)];
        let t3 = [u.by(g[2][0]).plus(v.by(g[2][1])).by(over), v.by(g[2][0]).minus(u.by(g[2][1])).by(over)];
        let turns = [t1, [WithRoot { a: c2, b: 0.0 }, WithRoot { a: 0.0, b: 1.0 }], t3];
        let [r, a, b] = self.displacements(&turns, square, true);
        let minor = |i: usize, j: usize| a[i].times(b[j], square).minus(a[j].times(b[i], square));
        let f = r[0].times(minor(1, 2), square).plus(r[1].times(minor(2, 0), square)).plus(r[2].times(minor(0, 1), square));
        AtGiven { turns, square, sine, f }
    }

    /// The product of both branches, a polynomial: where w is real as a product, so that it is right relative to its own size.
    fn product(&self, given: [Real; 2]) -> Real {
        let AtGiven { square, sine, f, .. } = self.at(given);
        sine * if square > 0.0 {
            let w = sqrt(square);
            f.at(w) * f.at(-w)
        } else {
            f.a * f.a - f.b * f.b * square
        }
    }

    /// All joints for a given first one and a branch.
    fn joints(&self, given: [Real; 2], at: &AtGiven, w: Real) -> [[Real; 2]; 6] {
        let mut turned = [[1.0, 0.0]; 3];
        for (turned, [c, s]) in turned.iter_mut().zip(&at.turns) {
            let (c, s) = (c.at(w), s.at(w));
            let n = length(c, s);
            *turned = if n > 0.0 { [c / n, s / n] } else { [1.0, 0.0] };
        }
        let [r, a, b] = self.displacements(&at.turns, at.square, false);
        let real = |v: [WithRoot; 3]| [v[0].at(w), v[1].at(w), v[2].at(w)];
        let (r, a, b) = (real(r), real(a), real(b));
        let m = cross(a, b);
        // Of parallel slides the first takes all.
        let parallel = dot(m, m) <= ROUNDING * ROUNDING;
        let over = if parallel { 0.0 } else { 1.0 / dot(m, m) };
        let mut lengths = [if parallel { dot(a, r) } else { dot(cross(b, r), m) * over }, dot(cross(r, a), m) * over].into_iter();
        let mut turned = turned.into_iter();
        let mut joints = [given; 6];
        for (i, joint) in joints.iter_mut().enumerate().skip(1) {
            *joint = if self.slides.contains(&i) {
                [lengths.next().unwrap_or(0.0), 0.0]
            } else {
                turned.next().unwrap_or([1.0, 0.0])
            };
        }
        joints
    }
}

/// Block 9, two prismatic joints: J1 L1 ... J6 L6 = 1 with joint 1 revolute and `slides` the numbers (from 0) of the prismatic joints, neighbours or not.
///
/// With t1, t2, t3 the other revolute joints, what stands between them is Rx(alpha) and Rx(beta) as a rotation, sin alpha and sin beta not 0.
/// 12 samples of the product above give the polynomial of degree 4, its orders 5 and 6 the rounding; block R gives the first joint, the sign
/// of f the branch, block 5 and two linear equations the rest, Newton's method the last digits.
///
/// - `length`: the arm's own, > 0. At most 8 solutions; `signs` are 0: the block has no branches.
/// - The links are made orthonormal first: w² and h² vanish together for rotations alone, and a pose is right to its own rounding.
/// - `near`: the number of solutions is not that of the roots, or rounding decides. The polynomial vanishes: `continuum`.
/// - Without solutions `miss` is the residual of a least-squares posture (the links' unit, angles times `length`).
pub fn two_slides(links: &[Frame; 6], slides: [usize; 2], length: Real) -> Branches<6, 8> {
    let mut unit = *links;
    for link in &mut unit {
        *link = orthonormal(link);
        for row in link.iter_mut() {
            row[3] /= length;
        }
    }
    let mut prismatic = [false; 6];
    for (i, kind) in prismatic.iter_mut().enumerate() {
        *kind = slides.contains(&i);
    }
    let (mut found, settled) = slides_at(&unit, slides, &prismatic);
    if found.near || found.count == 0 && !found.continuum {
        slides_from_beside(&mut found, settled, &unit, slides, &prismatic);
    }
    for branch in &mut found.all {
        for (value, prismatic) in branch.joints.iter_mut().zip(prismatic) {
            if prismatic {
                value[0] *= length;
            }
        }
    }
    found.miss *= length;
    found
}

/// Adds what closes the loop from the solutions of loops beside it. Where t1 and t3 turn about one axis the product has a double root,
/// whatever t1 is, though the postures there are regular: beside it each has a root of its own. All else `settled`, a loop beside that is certain
/// and has as many settles that, too.
#[cold]
#[inline(never)]
fn slides_from_beside(found: &mut Branches<6, 8>, settled: bool, unit: &[Frame; 6], slides: [usize; 2], prismatic: &[bool; 6]) {
    let closing = Loop { links: unit, prismatic: *prismatic, target: [0.0; 3], length: 1.0 };
    let before = found.count;
    let mut confirmed = false;
    for by in [BESIDE, FURTHER_BESIDE, BESIDE_CROWD] {
        if by.abs() > FURTHER_BESIDE.abs() && (confirmed || !settled) {
            continue;
        }
        let mut beside = *unit;
        // Not between the three turns, nor beside a joint that both slides are at right angles to.
        let place = if slides[1] == 5 && slides[0] == 1 { 4 } else { 5 };
        beside[place] = compose(&beside[place], &moved_by(by));
        let (others, _) = slides_at(&beside, slides, prismatic);
        confirmed |= !others.near && others.count == before && before > 0;
        for branch in others.found() {
            let closed = close_from_beside(&closing, &branch.joints);
            if closing.is_closed(&closed, false) {
                let known = found.count;
                merge(found, &closing, &closed, false);
                found.near |= found.count > known;
            }
        }
    }
    found.near &= !(settled && confirmed && found.count == before);
}

/// Two slides in units of the arm's length.
fn slides_at(unit: &[Frame; 6], slides: [usize; 2], prismatic: &[bool; 6]) -> (Branches<6, 8>, bool) {
    let mut found = Branches::new();
    let arm = TwoSlides::new(unit, slides);
    let mut samples = [0.0; 12];
    let mut largest: Real = 0.0;
    for (j, sample) in samples.iter_mut().enumerate() {
        *sample = arm.product([cosine_of_15_degrees(2 * j), cosine_of_15_degrees(2 * j + 18)]);
        largest = largest.max(sample.abs());
    }
    // Squares of volumes of displacements that are right to u.
    if !(largest > UNIT_ROUNDOFF * UNIT_ROUNDOFF) {
        found.continuum = largest <= UNIT_ROUNDOFF;
        found.near = !found.continuum;
        return (found, false);
    }
    let (a, b, noise) = fourier::<12, 5>(&samples, largest);
    let over = 1.0 / largest;
    let roots: CircleRoots<12> = circle_roots(&a, &b, (4.0 * noise).max(24.0 * UNIT_ROUNDOFF), 0.0, |points| {
        let mut values = [0.0; 9];
        for (value, point) in values.iter_mut().zip(points) {
            *value = arm.product(*point) * over;
        }
        values
    });
    let closing = Loop { links: unit, prismatic: *prismatic, target: [0.0; 3], length: 1.0 };
    found.continuum = roots.free;
    for root in roots.all.iter().take(roots.count) {
        let given = [root.c, root.s];
        let at = arm.at(given);
        let w = sqrt(at.square.max(0.0));
        let (plus, minus) = (at.f.at(w).abs(), at.f.at(-w).abs());
        // The branch that vanishes, or both that nearly do.
        for (w, f) in [(w, plus), (-w, minus)] {
            if f <= plus.min(minus) + 1e-3 * (plus + minus) {
                let closed = closing.close(&arm.joints(given, &at, w), root.double);
                if closing.is_closed(&closed, root.double) {
                    merge(&mut found, &closing, &closed, closed.residual > CLOSED);
                }
            }
        }
    }
    let distinct = found.count;
    let mut met = true;
    for root in roots.shallow.iter().take(roots.shallow_count) {
        let mut double = false;
        // Where t1 and t3 turn about one axis, two regular solutions may share this place. Beside it t1 is another on either side and for either w.
        for side in [-8.0 * SHALLOW, 8.0 * SHALLOW] {
            let given = back_on_circle([root.c - side * root.s, root.s + side * root.c]);
            let at = arm.at(given);
            let w = sqrt(at.square.max(0.0));
            for w in [w, -w] {
                let closed = closing.nearest(&arm.joints(given, &at, w), UNIT_ROUNDOFF);
                if closed.residual <= 2.0 * ROUNDING && closing.is_closed(&closed, true) {
                    double |= closed.double;
                    merge(&mut found, &closing, &closed, closed.double);
                }
            }
        }
        met &= double;
    }
    let settled = !roots.near && distinct == roots.count && met;
    found.near = !roots.free && (!settled || arm.axes_meet());
    if found.count == 0 && !found.continuum {
        // A root that rounding has lifted off 0 is at a least size.
        for (j, sample) in samples.iter().enumerate() {
            let beside = |by: usize| samples.get((j + by) % 12).map_or(0.0, |sample| sample.abs());
            if sample.abs() > beside(1) || sample.abs() > beside(11) {
                continue;
            }
            let given = [cosine_of_15_degrees(2 * j), cosine_of_15_degrees(2 * j + 18)];
            let at = arm.at(given);
            let w = sqrt(at.square.max(0.0));
            for w in [w, -w] {
                let nearest = closing.nearest(&arm.joints(given, &at, w), 1e-2);
                found.missed(nearest.residual);
                if closing.is_closed(&nearest, true) {
                    merge(&mut found, &closing, &nearest, true);
                }
                found.near |= nearest.residual <= CLOSED_AT_MOST;
            }
        }
    }
    (found, settled)
}
