// What is the same in every companion: everything after the line BEGIN is taken in as it stands. `Real`, `sin_cos` and the tables stand around it.
// BEGIN
/// A step of a function; operands are the numbers of earlier steps.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(dead_code)]
enum Step {
    /// Entry of an argument, by its name and its index.
    In(Name, u32),
    /// Number of the text, and how far it can be from the exact value that it stands for.
    Lit(Real, Real),
    /// Sine of an angle of the list.
    Sin(u32),
    /// Cosine of an angle of the list.
    Cos(u32),
    /// Sign of a joint rate.
    Sign(u32),
    /// What is left of Stribeck friction at a joint rate, and its velocity. // with Stribeck friction
    Stribeck(u32, Real), // with Stribeck friction
    /// Sign of a value. // with load friction
    SignOf(u32), // with load friction
    /// -a
    Neg(u32),
    /// a + b
    Add(u32, u32),
    /// a - b
    Sub(u32, u32),
    /// a b
    Mul(u32, u32),
    /// a b where a or b is an exact power of two: no rounding
    Scale(u32, u32),
    /// a b + c, rounded once // with fused operations
    Fma(u32, u32, u32), // with fused operations
    /// a / b
    Div(u32, u32),
}

/// A sum of joint variables, each with its factor, and a constant; 0 where there is none.
#[derive(Clone, Copy, Debug)]
struct Angle<'a> {
    terms: &'a [(u32, Real)],
    turn: Real,
    /// How far the constant can be from the exact value that it stands for.
    off: Real,
}

/// Name of an argument.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(dead_code)]
enum Name {
    Pi,
    Q,
    Dq,
    Ddq,
    Dqr,
    Ddqr,
    Tau,
    Gravity, // with gravity as an argument
}

/// Arguments, empty where a function has none of that name.
#[derive(Clone, Copy, Debug)]
struct Given<'a> {
    pi: &'a [Real],
    q: &'a [Real],
    dq: &'a [Real],
    ddq: &'a [Real],
    dqr: &'a [Real],
    ddqr: &'a [Real],
    tau: &'a [Real],
    g0: &'a [Real], // with gravity as an argument
}

const NONE: Given<'static> = Given { pi: &[], q: &[], dq: &[], ddq: &[], dqr: &[], ddqr: &[], tau: &[], g0: &[] };

/// Half of the distance from 1 to the next number.
const UNIT: Real = Real::EPSILON / 2.0;

/// The smallest normal number: more than what underflow takes away.
const TINY: Real = Real::MIN_POSITIVE;

/// A value as the function computes it, and how far it can be from the exact one.
#[derive(Clone, Copy, Debug)]
struct Bounded {
    value: Real,
    error: Real,
}

const NOTHING: Bounded = Bounded { value: 0.0, error: 0.0 };

fn plus(a: Bounded, b: Bounded) -> Bounded {
    let value = a.value + b.value;
    Bounded { value, error: a.error + b.error + UNIT * value.abs() }
}

fn scale(a: Bounded, b: Bounded) -> Bounded {
    let error = a.value.abs() * b.error + b.value.abs() * a.error + a.error * b.error;
    Bounded { value: a.value * b.value, error }
}

fn times(a: Bounded, b: Bounded) -> Bounded {
    let product = scale(a, b);
    Bounded { error: product.error + (UNIT * product.value.abs() + TINY), ..product }
}

/// A product that no rounding takes part in, unless it leaves the normal numbers.
fn scaled(a: Bounded, b: Bounded) -> Bounded {
    let product = scale(a, b);
    let lost = if product.value.abs() < TINY && a.value != 0.0 && b.value != 0.0 { TINY } else { 0.0 };
    Bounded { error: product.error + lost, ..product }
}

/// A product and a sum with one rounding. // with fused operations
fn fused(a: Bounded, b: Bounded, c: Bounded) -> Bounded { // with fused operations
    let value = Real::mul_add(a.value, b.value, c.value); // with fused operations
    Bounded { value, error: scale(a, b).error + c.error + (UNIT * value.abs() + TINY) } // with fused operations
} // with fused operations
 // with fused operations
fn over(a: Bounded, b: Bounded) -> Bounded {
    let value = a.value / b.value;
    // A hundredth more than the error, for the roundings of the error itself.
    let least = b.value.abs() - 1.01 * b.error;
    if least > 0.0 {
        Bounded { value, error: (a.error + value.abs() * b.error) / least + (2.0 * UNIT * value.abs() + TINY) }
    } else {
        // A divisor that may be 0.
        Bounded { value, error: Real::INFINITY }
    }
}

fn negated(a: Bounded) -> Bounded {
    Bounded { value: -a.value, ..a }
}

/// One unit in the last place, at an angle that is off by `angle`.
fn wave(value: Real, angle: Real) -> Bounded {
    Bounded { value, error: 2.0 * UNIT * value.abs() + TINY + angle }
}

/// The angle that a sum comes out as, and how far that is from the exact one: every term is rounded at most once, and so is every sum but the
/// first.
fn angle(sum: &Angle<'_>, q: impl Fn(usize) -> Real) -> Bounded {
    let (mut value, mut size, mut parts) = (0.0, 0.0, sum.terms.len());
    for &(joint, factor) in sum.terms {
        let term = factor * q(joint as usize);
        value += term;
        size += term.abs();
    }
    if sum.turn != 0.0 {
        value += sum.turn;
        size += sum.turn.abs();
        parts += 1;
    }
    let exact = parts == 1 && matches!(sum.terms, [(_, factor)] if factor.abs() == 1.0);
    Bounded { value, error: if exact { 0.0 } else { parts as Real * UNIT * size + sum.off } }
}

/// The sign of a rate; what is no number stays what it is.
fn sign(rate: Real) -> Bounded {
    let value = if rate > 0.0 {
        1.0
    } else if rate < 0.0 {
        -1.0
    } else {
        rate
    };
    Bounded { value, error: 0.0 }
}

/// Values of all steps with their running error bounds (Higham, Accuracy and Stability of Numerical Algorithms, 2002, Sect. 3.3).
fn forward(steps: &[Step], angles: &[Angle<'_>], given: &Given<'_>, values: &mut [Bounded]) {
    for (i, step) in steps.iter().enumerate() {
        let of = |step: u32| values[step as usize];
        values[i] = match *step {
            Step::In(name, index) => {
                let argument = match name {
                    Name::Pi => given.pi,
                    Name::Q => given.q,
                    Name::Dq => given.dq,
                    Name::Ddq => given.ddq,
                    Name::Dqr => given.dqr,
                    Name::Ddqr => given.ddqr,
                    Name::Tau => given.tau,
                    Name::Gravity => given.g0, // with gravity as an argument
                };
                Bounded { value: argument[index as usize], error: 0.0 }
            }
            Step::Lit(value, error) => Bounded { value, error },
            Step::Sin(index) | Step::Cos(index) => {
                let angle = angle(&angles[index as usize], |joint| given.q[joint]);
                let (sine, cosine) = sin_cos(angle.value);
                wave(if matches!(step, Step::Sin(_)) { sine } else { cosine }, angle.error)
            }
            Step::Sign(joint) => sign(given.dq[joint as usize]),
            Step::Stribeck(joint, velocity) => fading(given.dq[joint as usize], velocity), // with Stribeck friction
            Step::SignOf(a) => sign_of(of(a)), // with load friction
            Step::Neg(a) => negated(of(a)),
            Step::Add(a, b) => plus(of(a), of(b)),
            Step::Sub(a, b) => plus(of(a), negated(of(b))),
            Step::Mul(a, b) => times(of(a), of(b)),
            Step::Scale(a, b) => scaled(of(a), of(b)),
            Step::Fma(a, b, c) => fused(of(a), of(b), of(c)), // with fused operations
            Step::Div(a, b) => over(of(a), of(b)),
        };
    }
}

/// What the last rounding of a step can be.
fn rounding(step: &Step, value: &Bounded) -> Real {
    match step {
        Step::In(..) | Step::Sign(_) | Step::Neg(_) => 0.0,
        Step::Scale(..) if value.value.abs() < TINY => TINY,
        Step::Scale(..) => 0.0,
        Step::Lit(..) | Step::Sin(_) | Step::Cos(_) => value.error,
        Step::Stribeck(..) => value.error, // with Stribeck friction
        Step::SignOf(_) => value.error, // with load friction
        Step::Add(..) | Step::Sub(..) => UNIT * value.value.abs(),
        Step::Mul(..) => UNIT * value.value.abs() + TINY,
        Step::Fma(..) => UNIT * value.value.abs() + TINY, // with fused operations
        Step::Div(..) => 2.0 * UNIT * value.value.abs() + TINY,
    }
}

/// The bound of one entry by sensitivities: the sum of |d entry / d step| times the rounding of the step.
///
/// By the mean value theorem an entry is wrong by the sum of a_k delta_k, delta_k the rounding of step k and a_k its sensitivity at values between
/// the exact and the computed ones. These lie within the running bounds, so that sensitivities with running bounds of their own enclose the
/// a_k. In long functions, and where a function divides, errors take many ways to an entry and cancel; running bounds
/// alone add up their sizes.
fn backward(steps: &[Step], values: &[Bounded], sensitivities: &mut [Bounded], entry: u32) -> Real {
    sensitivities.fill(NOTHING);
    sensitivities[entry as usize].value = 1.0;
    let mut bound = 0.0;
    for i in (0..=entry as usize).rev() {
        let own = sensitivities[i];
        if own.value == 0.0 && own.error == 0.0 {
            continue;
        }
        bound += (own.value.abs() + own.error) * rounding(&steps[i], &values[i]);
        let mut add = |to: u32, part: Bounded| {
            let old = sensitivities[to as usize];
            sensitivities[to as usize] = if old.value == 0.0 && old.error == 0.0 { part } else { plus(old, part) };
        };
        match steps[i] {
            Step::In(..) | Step::Lit(..) | Step::Sin(_) | Step::Cos(_) | Step::Sign(_) => {}
            Step::Stribeck(..) => {} // with Stribeck friction
            Step::SignOf(_) => {} // with load friction
            Step::Neg(a) => add(a, negated(own)),
            Step::Add(a, b) => {
                add(a, own);
                add(b, own);
            }
            Step::Sub(a, b) => {
                add(a, own);
                add(b, negated(own));
            }
            Step::Mul(a, b) | Step::Scale(a, b) => {
                add(a, times(own, values[b as usize]));
                add(b, times(own, values[a as usize]));
            }
            Step::Fma(a, b, c) => { // with fused operations
                add(a, times(own, values[b as usize])); // with fused operations
                add(b, times(own, values[a as usize])); // with fused operations
                add(c, own); // with fused operations
            } // with fused operations
            Step::Div(a, b) => {
                let part = over(own, values[b as usize]);
                add(a, part);
                add(b, negated(times(part, values[i])));
            }
        }
    }
    bound
}

/// A bound made larger by the roundings of itself: a sum of products of numbers that are not negative, each operation right to a relative UNIT.
fn finished(bound: Real, steps: usize) -> Real {
    let inflated = bound * (1.0 + 32.0 * steps as Real * UNIT);
    if inflated < Real::INFINITY {
        inflated
    } else {
        Real::INFINITY
    }
}

/// Bounds of all entries: by sensitivities where there is room for them, else running ones.
fn all_bounds(steps: &[Step], entries: &[u32], values: &[Bounded], scratch: &mut [Bounded], bounds: &mut [Real]) {
    let sensitive = !scratch.is_empty();
    for (bound, &entry) in bounds.iter_mut().zip(entries) {
        let running = if sensitive { backward(steps, values, scratch, entry) } else { values[entry as usize].error };
        *bound = finished(running, steps.len());
    }
}

/// The bounds of a function given by its table; `SCRATCH` is `STEPS` for bounds by sensitivities, else 0.
fn bounds<const STEPS: usize, const ENTRIES: usize, const SCRATCH: usize>(
    steps: &[Step; STEPS],
    angles: &[Angle<'_>],
    entries: &[u32; ENTRIES],
    given: &Given<'_>,
) -> [Real; ENTRIES] {
    let (mut values, mut scratch, mut bounds) = ([NOTHING; STEPS], [NOTHING; SCRATCH], [0.0; ENTRIES]);
    forward(steps, angles, given, &mut values);
    all_bounds(steps, entries, &values, &mut scratch, &mut bounds);
    bounds
}
