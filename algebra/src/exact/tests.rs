use super::*;

fn rational(n: i64, d: i64) -> Number {
    Number::from(Rational::from(n) / Rational::from(d))
}

fn degrees(n: i64) -> Angle {
    Angle::new(&Number::pi() * &rational(n, 180))
}

#[test]
fn multiples_of_15_degrees_have_exact_sines() {
    for k in -48..48 {
        let angle = degrees(15 * k);
        let (s, c) = (angle.sin(), angle.cos());
        assert_eq!(&(&s * &s) + &(&c * &c), Number::one(), "{k}");
        let expected = (15.0 * k as f64).to_radians().sin();
        assert!((s.to_f64() - expected).abs() < 1e-13, "{k}: {s} = {} is not {expected}", s.to_f64());
    }
    assert_eq!(degrees(90).cos(), Number::zero());
    assert_eq!(degrees(75).sin().to_string(), "1/4*sqrt(2) + 1/4*sqrt(2)*sqrt(3)");
}

/// Sine and cosine of n/10 in units of 2^-300, right to 2^-200 for |n| < 2^20: Taylor's series at n/10 over 2^24, whose angle is doubled
/// 24 times. Each doubling multiplies the error by 4 at most, and the sum rounds 40 times.
fn sine_and_cosine_of_tenths(n: i64) -> (IBig, IBig) {
    let one = IBig::ONE << 300;
    let x: IBig = (&one * IBig::from(n)) / (IBig::from(10) << 24);
    let (mut s, mut c, mut power) = (IBig::ZERO, IBig::ZERO, one.clone());
    for k in 0..40 {
        match k % 4 {
            0 => c += &power,
            1 => s += &power,
            2 => c -= &power,
            _ => s -= &power,
        }
        power = &power * &x / (&one * IBig::from(k + 1));
    }
    for _ in 0..24 {
        (s, c) = (IBig::from(2) * &s * &c / &one, (&c * &c - &s * &s) / &one);
    }
    (s, c)
}

/// A float and nothing nearer: the value lies between the middles to its neighbours.
#[track_caller]
fn is_nearest(float: f64, value: &IBig) {
    let exact = |float: f64| Rational::try_from(float).expect("a finite float");
    let scaled = |float: f64, next: f64| (exact(float) + exact(next)) / Rational::from(2) * Rational::from(IBig::ONE << 300);
    let (low, high) = (scaled(float, float.next_down()), scaled(float, float.next_up()));
    let error = Rational::from(IBig::ONE << 100);
    let value = Rational::from(value.clone());
    assert!(low + &error < value && value < high - &error, "{float:e}");
}

#[test]
fn general_angles_are_points_of_the_circle_with_the_nearest_floats() {
    for n in [-70i64, -7, 1, 7, 14, 157, 1_000, 123_456] {
        let angle = Angle::new(rational(n, 10));
        let (s, c) = (angle.sin(), angle.cos());
        assert_eq!(&(&s * &s) + &(&c * &c), Number::one());
        let (sine, cosine) = sine_and_cosine_of_tenths(n);
        is_nearest(s.to_f64(), &sine);
        is_nearest(c.to_f64(), &cosine);
    }
    let mixed = Angle::new(&rational(7, 10) + &(&Number::pi() * &rational(1, 2)));
    assert_eq!(mixed.sin(), Angle::new(rational(7, 10)).cos());
    assert_eq!(mixed.cos(), -&Angle::new(rational(7, 10)).sin());
}

#[test]
fn roots_are_reduced() {
    let root = |n: i64| Number::from(n).sqrt().unwrap();
    assert_eq!(root(36), Number::from(6));
    assert_eq!(&root(2) * &root(3), root(6));
    assert_eq!(root(12), &Number::from(2) * &root(3));
    assert_eq!(rational(1, 2).sqrt().unwrap(), &root(2) * &rational(1, 2));
    assert_eq!(Number::from(-1).sqrt(), None);
    assert_eq!(&root(1_000_003) * &root(1_000_003), Number::from(1_000_003));
    let nested = (&Number::from(3) + &root(5)).sqrt().unwrap();
    assert_eq!(&nested * &nested, &Number::from(3) + &root(5));
    assert!((nested.to_f64() - (3.0 + 5.0f64.sqrt()).sqrt()).abs() < 1e-15);
}

#[test]
fn quotients_are_exact() {
    let root = |n: i64| Number::from(n).sqrt().unwrap();
    for divisor in
        [Number::from(7), root(2), &root(2) + &root(3), &Number::pi() * &root(5), &Number::one() + &(&root(2) - &root(6))]
    {
        let quotient = Number::from(5).checked_div(&divisor).unwrap();
        assert_eq!(&quotient * &divisor, Number::from(5), "{divisor}");
    }
    assert_eq!(Number::one().checked_div(&Number::zero()), None);
    // sqrt(3 - 2 sqrt(2)) is sqrt(2) - 1: zeros that no reduction sees, as the number and as its conjugate.
    let unseen = (&Number::from(3) - &(&Number::from(2) * &root(2))).sqrt().unwrap();
    let one = Number::one();
    assert_eq!(one.checked_div(&(&(&unseen + &one) - &root(2))), None);
    let quotient = one.checked_div(&(&(&unseen + &one) + &root(2))).unwrap();
    assert!((quotient.to_f64() - 0.125f64.sqrt()).abs() < 1e-16);
    // Many roots are not rationalised.
    let many = [2, 3, 5, 7, 11, 13, 17, 19].iter().fold(Number::one(), |sum, &n| &sum + &root(n));
    let quotient = one.checked_div(&many).unwrap();
    assert!((quotient.to_f64() - 1.0 / many.to_f64()).abs() < 1e-16);
    assert!(quotient.terms().count() <= 64);
    let opaque = Number::one().checked_div(&(&Number::one() + &Number::pi())).unwrap();
    assert!((opaque.to_f64() - 1.0 / (1.0 + std::f64::consts::PI)).abs() < 1e-16);
}

#[test]
fn divisors_cancel_and_stand_once() {
    let (angle, one) = (Angle::new(rational(7, 10)), Number::one());
    for value in [angle.sin(), angle.cos(), Number::pi(), &angle.sin() * &angle.cos()] {
        let inverse = one.checked_div(&value).unwrap();
        assert_eq!(&inverse * &value, one, "{value}");
    }
    let sum = &angle.cos() + &(&Number::from(2) * &Number::pi());
    let quotient = sum.checked_div(&(&one + &Number::pi())).unwrap();
    assert_eq!(quotient.to_string(), "(2*pi + cos(7/10))*(1/(1 + pi))");
    assert_eq!((&one - &quotient).to_string(), "1 + (-2*pi - cos(7/10))*(1/(1 + pi))");
    assert_eq!(one.checked_div(&(&angle.cos() * &angle.cos())).unwrap().to_string(), "cos(7/10)^(-2)");
    // Two terms of two factors each, twice the two terms and one factor of 1 + pi, and the term of the angle.
    assert!(quotient.is_within(13) && !quotient.is_within(12));
    // One over a number that is 0 to the first digits.
    let small = Angle::new(Number::from(Rational::from_parts(1.into(), UBig::from(10u8).pow(100))));
    let large = one.checked_div(&small.sin()).unwrap().to_f64();
    assert!((large / 1e100 - 1.0).abs() < 1e-15, "{large}");
}

#[test]
fn floats_are_the_nearest() {
    assert_eq!(Number::pi().to_f64(), std::f64::consts::PI);
    assert_eq!(Number::pi().to_f32(), std::f32::consts::PI);
    assert_eq!(Number::from(2).sqrt().unwrap().to_f64(), std::f64::consts::SQRT_2);
    for text in ["0.1", "9.81", "1e-320", "1.7976931348623157e308", "4.9e-324", "0.000244140625", "1e22", "123456789.123456789"] {
        let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits = Rational::from(format!("{whole}{fraction}").parse::<IBig>().unwrap());
        let power = exponent.parse::<i32>().unwrap() - fraction.len() as i32;
        let ten = Rational::from(UBig::from(10u8).pow(power.unsigned_abs() as usize));
        let exact = Number::from(if power < 0 { digits / ten } else { digits * ten });
        assert_eq!(exact.to_f64(), text.parse::<f64>().unwrap(), "{text}");
        assert_eq!(exact.to_f32(), text.parse::<f32>().unwrap(), "{text}");
    }
}

#[test]
fn signs_are_exact() {
    let close = &Number::from(2).sqrt().unwrap() - &rational(665857, 470832);
    assert_eq!(close.sign(), Ordering::Less);
    assert_eq!((&Number::pi() - &rational(355, 113)).sign(), Ordering::Less);
    assert_eq!((&Number::pi() - &rational(22, 7)).sign(), Ordering::Less);
    assert_eq!((&Number::pi() - &rational(333, 106)).sign(), Ordering::Greater);
}

#[test]
fn enclosures_are_tight_whatever_the_sizes() {
    // A large root over a larger number, and its inverse: at 2^-160 the one is [0, 1] times 10^150.
    let large = Number::from(Rational::from(IBig::from(10).pow(301) + IBig::ONE));
    let small = large.sqrt().unwrap().checked_div(&(&large * &large)).unwrap();
    let inverse = Number::one().checked_div(&small).unwrap();
    let atom = Number::one().checked_div(&(&small + &Number::pi())).unwrap();
    for number in [&small, &inverse, &atom, &Angle::new(small.clone()).sin(), &Angle::new(inverse.clone()).cos()] {
        for bits in [1, 96, 256] {
            let (low, high) = number.enclose(bits);
            assert!(low <= high && (high - low) * Rational::from(UBig::ONE << bits) < Rational::ONE, "{number} to {bits} bits");
        }
    }
    assert_eq!(small.sign(), Ordering::Greater);
    assert_eq!((small.to_f64(), inverse.to_f64()), (0.0, f64::INFINITY));
    assert_eq!(Angle::new(small).sin().sign(), Ordering::Greater);
}

type Rotation = [[Number; 3]; 3];

/// The product in which sums are shared.
fn product(a: &Rotation, b: &Rotation) -> Rotation {
    let entry = |i: usize, j: usize| (0..3).fold(Number::zero(), |sum, k| sum.plus(&a[i][k].times(&b[k][j])));
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// A chain of rotations about x and z by general angles, and the same in floats.
fn chain(rotations: i64) -> (Rotation, [[f64; 3]; 3]) {
    let number = |n: i64| Number::from(n);
    let mut exact: Rotation = std::array::from_fn(|i| std::array::from_fn(|j| number(i64::from(i == j))));
    let mut floats = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for n in 0..rotations {
        let angle = Angle::new(rational(17 + 3 * n, 100));
        let (s, c) = (angle.sin(), angle.cos());
        let next: Rotation = if n % 2 == 0 {
            [[number(1), number(0), number(0)], [number(0), c.clone(), -&s], [number(0), s, c]]
        } else {
            [[c.clone(), -&s, number(0)], [s, c, number(0)], [number(0), number(0), number(1)]]
        };
        let next_floats = next.each_ref().map(|row| row.each_ref().map(Number::to_f64));
        exact = product(&exact, &next);
        floats = std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| floats[i][k] * next_floats[k][j]).sum()));
    }
    (exact, floats)
}

#[test]
fn products_of_many_rotations_stay_short_and_keep_their_values() {
    let mut lengths = Vec::new();
    for rotations in [8, 16, 32, 64] {
        let (exact, floats) = chain(rotations);
        let mut definitions = Definitions::default();
        let mut length = 0;
        for (number, float) in exact.iter().flatten().zip(floats.iter().flatten()) {
            assert!(number.terms().count() <= shared::MOST_TERMS);
            assert!((number.to_f64() - float).abs() < 1e-14, "{rotations}: {} is not {float}", number.to_f64());
            length += definitions.formula(number).len();
        }
        length += definitions.texts().iter().map(String::len).sum::<usize>();
        lengths.push(length);
    }
    // Once they are shared, the length grows with the number of rotations; multiplied out, each would double it.
    assert!(lengths[3] < 3 * lengths[2] && lengths[2] < 5 * lengths[1], "{lengths:?}");
    assert!(lengths[3] < 1_000_000, "{lengths:?}");
}

#[test]
fn a_long_sum_is_one_factor_in_formulas() {
    let (exact, _) = chain(12);
    let number = &exact[0][0];
    assert!(number.is_shared() && !number.is_readable());
    assert!(number.to_string().contains('≈'), "{number}");
    let mut definitions = Definitions::default();
    let formula = definitions.formula(number);
    // Every definition is of use, and each refers to those before it only.
    let named = |text: &str| -> Vec<usize> {
        let numbers = text.split('k').skip(1).map(|rest| rest.split(|c: char| !c.is_ascii_digit()).next().unwrap_or_default());
        numbers.map(|number| number.parse().expect("k and a number")).collect()
    };
    let mut unused: Vec<usize> = (0..definitions.texts().len()).collect();
    assert!(!unused.is_empty());
    for (index, text) in definitions.texts().iter().chain([&formula]).enumerate() {
        let refers = named(text);
        assert!(refers.iter().all(|&other| other < index), "k{index}: {text}");
        unused.retain(|other| !refers.contains(other));
    }
    assert_eq!(unused, Vec::<usize>::new());
    // A product of two such factors cancels against itself.
    let factors = exact[1][1].times(&exact[2][2]);
    assert!(factors.checked_div(&factors).expect("not 0").is_one());
    let square = number.times(number);
    assert!((square.sqrt().expect("a square").to_f64() - number.to_f64().abs()).abs() < 1e-15);
}
