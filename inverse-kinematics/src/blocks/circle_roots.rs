// Block R: all real roots of a trigonometric polynomial of low degree.
//
// The circle is covered by arcs. On an arc of half width h the polynomial is its Taylor polynomial of degree 8 about the centre, in
// x = (angle - centre)/h, up to a remainder that is known. Where the constant term outweighs the rest there is no root; where the linear
// term outweighs what is above it there is at most one, and the signs at the ends tell; otherwise the arc is halved.
// Where the polynomial is weak, that is, comparable with its own noise, its coefficients say too little: the caller then gives the
// function itself at nine points of the arc, and the same test runs on their interpolation polynomial.

/// A root of a trigonometric polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleRoot {
    /// The cosine of the root.
    pub c: Real,
    /// The sine of the root.
    pub s: Real,
    /// A place at which |f| is so small that rounding decides between two roots and none; it stands for both.
    pub double: bool,
    /// How far the noise may have moved it, rad.
    pub error: Real,
}

/// The roots that [`circle_roots`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleRoots<const M: usize> {
    /// How many of `all` count.
    pub count: usize,
    /// The roots, anticlockwise from (1, 0).
    pub all: [CircleRoot; M],
    /// Some root is `double`, or the bounds on work or room ended the search: there may be two roots fewer or more.
    pub near: bool,
    /// The same whatever becomes of the `double` ones: the bounds on work or room ended the search, or the others are odd in number.
    pub ended: bool,
    /// The polynomial vanishes: all amplitudes are within the noise. No root is given.
    pub free: bool,
    /// Minima of |f| that are not roots, but nearly: as flat as between two roots 2 [`SHALLOW`] apart. Rounding of what f
    /// was computed from may make roots of them.
    pub shallow: [CircleRoot; 4],
    /// How many of `shallow` count.
    pub shallow_count: usize,
    /// How often the function itself was asked for on an arc.
    pub anew: usize,
    /// Of the first and the last root: within what they are one with what is found beside them, and whether f rises there.
    ends: [(Real, bool); 2],
}

/// How often one search may halve an arc, and how often it may ask for the function itself on an arc: many times what generic polynomials of
/// degree 8 need (about 60, and 0 to 3).
const HALVINGS: usize = 1000;
const ANEW: usize = 240;

/// Arcs are not halved below this half width, rad, 7e-8 in double precision: two roots as near as that are one change by rounding apart,
/// since rounding of the coefficients by u moves a double root by sqrt(u).
const SHORTEST: Real = 8.0;

/// Coefficients of the Chebyshev polynomials T0 to T8, by powers.
const CHEBYSHEV: [[Real; 9]; 9] = [
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [-1.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, -3.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 0.0, -8.0, 0.0, 8.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 5.0, 0.0, -20.0, 0.0, 16.0, 0.0, 0.0, 0.0],
    [-1.0, 0.0, 18.0, 0.0, -48.0, 0.0, 32.0, 0.0, 0.0],
    [0.0, -7.0, 0.0, 56.0, 0.0, -112.0, 0.0, 64.0, 0.0],
    [1.0, 0.0, -32.0, 0.0, 160.0, 0.0, -256.0, 0.0, 128.0],
];

/// cos(j pi/18) for j = 0 to 9; the others follow from symmetry.
const COSINES_OF_10_DEGREES: [Real; 10] = [
    1.0,
    0.984807753012208059366743024589523014,
    0.939692620785908384054109277324731470,
    0.866025403784438646763723170752936183,
    0.766044443118978035202392650555416674,
    0.642787609686539326322643409907263433,
    0.5,
    0.342020143325668733044099614682259581,
    0.173648177666930348851716626769314796,
    0.0,
];

/// cos(j pi/18) for j >= 0.
#[inline]
fn cosine_of_10_degrees(j: usize) -> Real {
    let j = j % 36;
    let j = if j > 18 { 36 - j } else { j };
    let (i, sign) = if j > 9 { (18 - j, -1.0) } else { (j, 1.0) };
    COSINES_OF_10_DEGREES.get(i).map_or(0.0, |c| sign * c)
}

/// So many Taylor coefficients are looked at where the polynomial is weak.
const TERMS: usize = 17;

/// A trigonometric polynomial a_0 + sum_k a_k cos kt + b_k sin kt, with what the search needs of it.
struct TrigonometricPolynomial<'a, const N: usize> {
    a: &'a [Real; N],
    b: &'a [Real; N],
    /// The half width h of the first arcs.
    h: Real,
    /// weights[k][j] = (k h)^j / j!.
    weights: [[Real; TERMS]; N],
    /// sum_k (|a_k| + |b_k|) (k h)^9 / 9!: the remainder on the first arcs.
    remainder: Real,
    /// The same with `TERMS` for 9.
    last: Real,
}

impl<'a, const N: usize> TrigonometricPolynomial<'a, N> {
    fn new(a: &'a [Real; N], b: &'a [Real; N]) -> Self {
        const PI: Real = 3.141592653589793238462643383279502884;
        let h = PI / (4 * (N - 1)) as Real;
        let mut weights = [[0.0; TERMS]; N];
        let (mut remainder, mut last) = (0.0, 0.0);
        for (k, ((row, a), b)) in weights.iter_mut().zip(a).zip(b).enumerate() {
            let mut w = 1.0;
            for (j, weight) in row.iter_mut().enumerate() {
                *weight = w;
                w *= k as Real * h / (j + 1) as Real;
            }
            remainder += (a.abs() + b.abs()) * row[9];
            last += (a.abs() + b.abs()) * w;
        }
        TrigonometricPolynomial { a, b, h, weights, remainder, last }
    }

    /// Value and derivative.
    fn at(&self, c: Real, s: Real) -> (Real, Real) {
        let (mut ck, mut sk) = (1.0, 0.0);
        let (mut value, mut slope) = (0.0, 0.0);
        for (k, (a, b)) in self.a.iter().zip(self.b).enumerate() {
            value += a * ck + b * sk;
            slope += k as Real * (b * ck - a * sk);
            (ck, sk) = (ck * c - sk * s, sk * c + ck * s);
        }
        (value, slope)
    }

    /// Taylor coefficients about (c, s) in units of the half width h `part`.
    fn taylor(&self, c: Real, s: Real, part: Real) -> [Real; 9] {
        let mut t = [0.0; 9];
        let (mut ck, mut sk) = (1.0, 0.0);
        for ((w, a), b) in self.weights.iter().zip(self.a).zip(self.b) {
            let (u, v) = (a * ck + b * sk, b * ck - a * sk);
            let signed = [u, v, -u, -v, u, v, -u, -v, u];
            for j in 0..9 {
                t[j] += signed[j] * w[j];
            }
            (ck, sk) = (ck * c - sk * s, sk * c + ck * s);
        }
        let mut p = 1.0;
        for t in &mut t {
            *t *= p;
            p *= part;
        }
        t
    }
}

impl<const N: usize> TrigonometricPolynomial<'_, N> {
    /// A bound of what interpolation at the nine Chebyshev points of the arc about (c, s) leaves: of x^9 and x^10 at most 2^-8, of any higher
    /// power at most 4 (1 and the Lebesgue constant). Where f is small its high derivatives are too, so that this is far below the bound by the
    /// amplitudes.
    fn left_by_interpolation(&self, c: Real, s: Real, part: Real) -> Real {
        let mut t = [0.0; TERMS];
        let (mut ck, mut sk) = (1.0, 0.0);
        for ((w, a), b) in self.weights.iter().zip(self.a).zip(self.b) {
            let pair = [a * ck + b * sk, b * ck - a * sk];
            for j in 9..TERMS {
                // The signs of derivatives: + + - -.
                let term = pair[j % 2] * w[j];
                t[j] += if j / 2 % 2 == 0 { term } else { -term };
            }
            (ck, sk) = (ck * c - sk * s, sk * c + ck * s);
        }
        let mut sum = self.last;
        for j in (9..TERMS).rev() {
            sum = sum * part + t[j].abs() * if j < 11 { 1.0 / 1024.0 } else { 1.0 };
        }
        let cube = part * part * part;
        4.0 * sum * (cube * cube * cube)
    }
}

/// What the coefficients of a polynomial say of its roots in [-1, 1].
enum Interval {
    /// There are none.
    Empty,
    /// It is monotone there.
    Monotone,
    /// They do not tell.
    Open,
}

/// Judges a polynomial that is known up to `error`, its derivative up to 9 times that.
fn judge(t: &[Real; 9], error: Real) -> Interval {
    let (mut rest, mut slopes) = (0.0, 0.0);
    for (j, t) in t.iter().enumerate().skip(2) {
        rest += t.abs();
        slopes += j as Real * t.abs();
    }
    if t[0].abs() > t[1].abs() + rest + error {
        Interval::Empty
    } else if t[1].abs() > slopes + 9.0 * error {
        Interval::Monotone
    } else {
        Interval::Open
    }
}

/// The sum of the absolute values of the coefficients: a bound of the polynomial on [-1, 1].
fn largest(t: &[Real; 9]) -> Real {
    t.iter().fold(0.0, |sum: Real, t| sum + t.abs())
}

/// Value and derivative of a polynomial.
fn value_and_slope(t: &[Real; 9], x: Real) -> (Real, Real) {
    let (mut value, mut slope) = (0.0, 0.0);
    for t in t.iter().rev() {
        slope = slope * x + value;
        value = value * x + t;
    }
    (value, slope)
}

/// The root of a polynomial that is monotone on [-1, 1] and has one there, or just outside: Newton's method kept in its bracket.
fn root_of_monotone(t: &[Real; 9]) -> Real {
    let rising = t[1] > 0.0;
    let (mut low, mut high, mut x) = (-1.0, 1.0, (-t[0] / t[1]).clamp(-1.0, 1.0));
    for _ in 0..30 {
        let (value, slope) = value_and_slope(t, x);
        if (value > 0.0) == rising {
            high = x;
        } else {
            low = x;
        }
        let newton = x - value / slope;
        let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
        if (next - x).abs() <= 4.0 * UNIT_ROUNDOFF {
            return next;
        }
        x = next;
    }
    x
}

/// The minimum of |t| near 0, by its parabola.
fn minimum(t: &[Real; 9]) -> Real {
    if t[2].abs() > 0.5 * t[1].abs() {
        -0.5 * t[1] / t[2]
    } else {
        0.0
    }
}

impl<const M: usize> CircleRoots<M> {
    /// Adds a root unless it is one that has been found: roots come in order along the circle, so only the last and the first can be it.
    /// Two crossings that are one to rounding, up and down, are a double root.
    fn add(&mut self, root: CircleRoot, apart: Real, rising: bool) {
        // Onto the circle: turn by turn it has been left by some rounding.
        let [c, s] = back_on_circle([root.c, root.s]);
        let root = CircleRoot { c, s, ..root };
        self.near |= root.double;
        let [first, last] = self.ends;
        let places = [(self.count.wrapping_sub(1), last), (0, first)];
        for (place, (known_apart, known_rising)) in places.into_iter().take(self.count) {
            let width = apart.max(known_apart);
            let Some(known) = self.all.get_mut(place) else { continue };
            if (known.c - root.c).abs() + (known.s - root.s).abs() <= width {
                known.double |= root.double || known_rising != rising;
                self.near |= known.double;
                self.ends[1].0 = width;
                return;
            }
        }
        if let Some(slot) = self.all.get_mut(self.count) {
            *slot = root;
            self.ends[1] = (apart, rising);
            if self.count == 0 {
                self.ends[0] = self.ends[1];
            }
            self.count += 1;
        } else {
            (self.near, self.ended) = (true, true);
        }
    }
}

/// What is found in an interval.
enum Kind {
    /// A root, at which the function rises or falls.
    Crossing { rising: bool },
    /// Two roots or none.
    Contact,
    /// No root, but nearly.
    Shallow,
}

impl<const M: usize> CircleRoots<M> {
    /// Adds what was found at (c, s), right to `apart` rad.
    fn add_kind(&mut self, c: Real, s: Real, apart: Real, kind: Kind) {
        let root = CircleRoot { c, s, double: !matches!(kind, Kind::Crossing { .. }), error: apart };
        match kind {
            Kind::Crossing { rising } => self.add(root, apart, rising),
            Kind::Contact => self.add(root, apart, false),
            Kind::Shallow => {
                let known = self.shallow.iter().take(self.shallow_count);
                let width = 8.0 * SHALLOW;
                if known.into_iter().any(|known| (known.c - c).abs() + (known.s - s).abs() <= width) {
                    return;
                }
                if let Some(slot) = self.shallow.get_mut(self.shallow_count) {
                    *slot = root;
                    self.shallow_count += 1;
                } else {
                    (self.near, self.ended) = (true, true);
                }
            }
        }
    }
}

impl<const M: usize> CircleRoots<M> {
    /// Short arcs beside two roots that nearly meet look like shallow minima: they are where the halving that told the two apart has ended.
    fn drop_shallow_beside_roots(&mut self) {
        let near = |x: &CircleRoot, y: &CircleRoot| (x.c - y.c).abs() + (x.s - y.s).abs() <= 8.0 * SHALLOW;
        let mut kept = 0;
        for place in 0..self.shallow_count {
            let Some(minimum) = self.shallow.get(place).copied() else { break };
            let roots = self.all.iter().take(self.count);
            if roots.filter(|root| !root.double && near(root, &minimum)).count() < 2 {
                if let Some(slot) = self.shallow.get_mut(kept) {
                    *slot = minimum;
                    kept += 1;
                }
            }
        }
        self.shallow_count = kept;
    }
}

/// Block R: all real roots of f(t) = a_0 + sum over k < N of a_k cos kt + b_k sin kt, on the circle (c, s) = (cos t, sin t).
///
/// 4 (N - 1) equal arcs, each a Taylor polynomial of degree 8 with remainder <= sum_k (|a_k| + |b_k|) (kh)^9/9! (above). The ends of an arc
/// count with it if |f| is within the noise there, so no root is lost between two arcs; what is found twice is found to be one.
///
/// - `b[0]` is not read. `noise`: how far the coefficients' rounding may move f, > 0; that of evaluating f is added here.
/// - `exact`: f itself, right relative to its largest value nearby, at nine points (c, s): Chebyshev's of an arc of half width
///   <= pi/256 on which |f| stays below [`WEAK`] times the noise. There the noise is 1e-13 of the largest value (1000 u), and what
///   interpolation leaves is bounded by the next Taylor coefficients.
/// - `floor`: how far rounding of what f is computed from may move f, wherever it is: added to the noise of `exact`. Where nobody knows it is 0,
///   and `shallow` lists the places that may be roots all the same.
/// - Two roots nearer than 16 sqrt(u) rad, or a minimum of |f| as flat as that: one root, `double`, and `near`.
/// - All amplitudes within the noise, f = 0 included: `free`. A coefficient that is not finite: `near` without a root.
/// - At most `HALVINGS` arcs are halved and `ANEW` interpolated; where that ends the search it says `near`.
pub fn circle_roots<const N: usize, const M: usize>(
    a: &[Real; N],
    b: &[Real; N],
    noise: Real,
    floor: Real,
    mut exact: impl FnMut(&[[Real; 2]; 9]) -> [Real; 9],
) -> CircleRoots<M> {
    let root = CircleRoot { c: 1.0, s: 0.0, double: false, error: 0.0 };
    let mut found = CircleRoots {
        count: 0,
        all: [root; M],
        near: false,
        ended: false,
        free: false,
        shallow: [root; 4],
        shallow_count: 0,
        anew: 0,
        ends: [(0.0, false); 2],
    };
    let mut amplitude = 0.0;
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        amplitude += a.abs() + if k == 0 { 0.0 } else { b.abs() };
    }
    if !(amplitude < Real::MAX) || N < 2 {
        (found.near, found.ended) = (true, true);
        return found;
    }
    // N operations' rounding, for a value near the largest.
    let noise = noise + 4.0 * UNIT_ROUNDOFF * amplitude;
    if amplitude <= noise {
        found.free = true;
        return found;
    }
    let f = TrigonometricPolynomial::new(a, b);
    let shortest = SHORTEST * sqrt(UNIT_ROUNDOFF);
    let mut halvings = HALVINGS;

    let (first, step) = (small_turn(f.h), small_turn(0.5 * f.h));
    let step = {
        // Turn by 2 h, from h/2.
        let (c, s) = step;
        let (c, s) = (c * c - s * s, 2.0 * c * s);
        (c * c - s * s, 2.0 * c * s)
    };
    let mut centre = first;
    // Arcs to be looked at: centre, and what part of the first half width they have. Each halving leaves one more.
    let mut arcs = [(0.0, 0.0, 0.0); 32];
    for _ in 0..4 * (N - 1) {
        let mut open = 1;
        arcs[0] = (centre.0, centre.1, 1.0);
        centre = (centre.0 * step.0 - centre.1 * step.1, centre.1 * step.0 + centre.0 * step.1);
        while open > 0 && open <= arcs.len() {
            open -= 1;
            let (c, s, part) = arcs[open];
            let h = f.h * part;
            let t = f.taylor(c, s, part);
            let cube = part * part * part;
            let remainder = f.remainder * (cube * cube * cube);
            let turned = |x: Real| {
                let (cx, sx) = small_turn(h * x);
                (c * cx - s * sx, s * cx + c * sx)
            };
            match judge(&t, remainder + noise) {
                Interval::Empty => {
                    if h <= SHALLOW {
                        let (c, s) = turned(minimum(&t).clamp(-1.0, 1.0));
                        found.add_kind(c, s, h, Kind::Shallow);
                    }
                    continue;
                }
                _ if largest(&t) < WEAK * noise && h <= 0.0123 && found.anew < ANEW => {
                    let remainder = f.left_by_interpolation(c, s, part);
                    found.anew += 1;
                    let mut points = [[0.0; 2]; 9];
                    for (i, point) in points.iter_mut().enumerate() {
                        let (c, s) = turned(cosine_of_10_degrees(2 * i + 1));
                        *point = [c, s];
                    }
                    let values = exact(&points);
                    let size = values.iter().fold(0.0, |size: Real, value| size.max(value.abs()));
                    if remainder <= sqrt(UNIT_ROUNDOFF) * size || h <= shortest {
                        let t = interpolation(&values);
                        let error = 1000.0 * UNIT_ROUNDOFF * size + remainder + floor;
                        let widths = [shortest / h, SHALLOW / h];
                        roots_of_interpolation(&t, error, widths, &mut halvings, &mut |x, width, kind| {
                            let (c, s) = turned(x);
                            found.add_kind(c, s, width * h + 8.0 * UNIT_ROUNDOFF, kind);
                        });
                        continue;
                    }
                }
                Interval::Monotone => {
                    let (low, high) = (turned(-1.0), turned(1.0));
                    let (low, high) = (f.at(low.0, low.1).0, f.at(high.0, high.1).0);
                    // Beside the noise, the ends of neighbours do not meet exactly: each has been turned by as many rounded steps as arcs.
                    let slack = noise + 256.0 * UNIT_ROUNDOFF * t[1].abs() / h;
                    if (low > 0.0) == (high > 0.0) && low.abs() > slack && high.abs() > slack {
                        continue;
                    }
                    let (mut c, mut s) = turned(root_of_monotone(&t));
                    let mut slope = t[1] / h;
                    for _ in 0..2 {
                        let (value, derivative) = f.at(c, s);
                        slope = derivative;
                        let (cx, sx) = small_turn((-value / slope).max(-h).min(h));
                        (c, s) = (c * cx - s * sx, s * cx + c * sx);
                    }
                    let apart = 4.0 * slack / slope.abs();
                    found.add_kind(c, s, apart, Kind::Crossing { rising: slope > 0.0 });
                    continue;
                }
                Interval::Open => {}
            }
            if h <= shortest || halvings == 0 || open + 2 > arcs.len() {
                let (c, s) = turned(minimum(&t).clamp(-1.0, 1.0));
                found.add_kind(c, s, 4.0 * h, Kind::Contact);
                continue;
            }
            halvings -= 1;
            let (left, right) = (turned(-0.5), turned(0.5));
            arcs[open] = (right.0, right.1, 0.5 * part);
            arcs[open + 1] = (left.0, left.1, 0.5 * part);
            open += 2;
        }
    }
    found.drop_shallow_beside_roots();
    // They are even in number, each double one counted twice.
    let single = found.all.iter().take(found.count).filter(|root| !root.double).count();
    found.ended |= single % 2 == 1 || halvings == 0;
    found.near |= found.ended;
    found
}

/// The polynomial of degree 8 with the given values at the Chebyshev points cos((2i + 1) pi/18), by powers.
fn interpolation(values: &[Real; 9]) -> [Real; 9] {
    let mut t = [0.0; 9];
    for (k, row) in CHEBYSHEV.iter().enumerate() {
        let mut sum = 0.0;
        for (i, value) in values.iter().enumerate() {
            sum += value * cosine_of_10_degrees(k * (2 * i + 1));
        }
        let coefficient = sum * if k == 0 { 1.0 / 9.0 } else { 2.0 / 9.0 };
        for (t, power) in t.iter_mut().zip(row) {
            *t += coefficient * power;
        }
    }
    t
}

/// The roots in [-1, 1] of a polynomial that is known up to `error`, handed to `found` with the width within which they are one. Intervals are
/// not halved below the half width `shortest`; those without a root below `shallow` are next to a shallow minimum.
fn roots_of_interpolation(
    t: &[Real; 9],
    error: Real,
    [shortest, shallow]: [Real; 2],
    halvings: &mut usize,
    found: &mut impl FnMut(Real, Real, Kind),
) {
    let mut intervals = [(0.0, 0.0); 32];
    let mut open = 1;
    intervals[0] = (0.0, 1.0);
    while open > 0 && open <= intervals.len() {
        open -= 1;
        let (x, width) = intervals[open];
        // About x, in units of the width.
        let mut local = *t;
        for i in 0..8 {
            for j in (i..8).rev() {
                local[j] += x * local[j + 1];
            }
        }
        let mut power = 1.0;
        for t in &mut local {
            *t *= power;
            power *= width;
        }
        match judge(&local, error) {
            Interval::Empty => {
                if width <= shallow {
                    found(x + width * minimum(&local).clamp(-1.0, 1.0), width, Kind::Shallow);
                }
                continue;
            }
            Interval::Monotone => {
                let (low, high) = (value_and_slope(&local, -1.0).0, value_and_slope(&local, 1.0).0);
                if (low > 0.0) != (high > 0.0) || low.abs() <= error || high.abs() <= error {
                    found(x + width * root_of_monotone(&local), 4.0 * width * error / local[1].abs(), Kind::Crossing { rising: local[1] > 0.0 });
                }
                continue;
            }
            Interval::Open => {}
        }
        if width <= shortest || *halvings == 0 || open + 2 > intervals.len() {
            found(x + width * minimum(&local).clamp(-1.0, 1.0), 4.0 * width, Kind::Contact);
            continue;
        }
        *halvings -= 1;
        intervals[open] = (x + 0.5 * width, 0.5 * width);
        intervals[open + 1] = (x - 0.5 * width, 0.5 * width);
        open += 2;
    }
}
