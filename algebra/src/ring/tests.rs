use super::*;
use crate::exact::Rational;

fn pool() -> Pool {
    Pool::new(Field::for_constants([]))
}

#[test]
fn equal_polynomials_are_one_node() {
    let mut p = pool();
    let (s, c) = (p.symbol(Symbol::Sine(0)), p.symbol(Symbol::Cosine(0)));
    let (x, y, z) = (p.symbol(Symbol::Rate(0)), p.symbol(Symbol::Rate(1)), p.symbol(Symbol::Rate(2)));
    let (ss, cc) = (p.mul(s, s), p.mul(c, c));
    assert_eq!(p.add(ss, cc), ExprId::ONE);
    let (xz, yz) = (p.mul(x, z), p.mul(y, z));
    let (sum, expanded) = (p.add(x, y), p.add(xz, yz));
    assert_eq!(p.mul(z, sum), expanded);
    let (difference, reverse) = (p.sub(x, y), p.sub(y, x));
    assert_eq!(difference, -reverse);
    assert_eq!(p.add(difference, reverse), ExprId::ZERO);
    let seven = p.integer(7);
    let (seven_ss, seven_cc) = (p.mul(seven, ss), p.mul(seven, cc));
    assert_eq!(p.add(seven_ss, seven_cc), seven, "a constant is found where no symbol is left");
    let reciprocal = p.reciprocal(sum);
    assert_eq!(p.mul(reciprocal, sum), ExprId::ONE);
}

#[test]
fn what_divides_by_a_constant_without_a_simple_inverse_cancels() {
    let one_and_pi = &Number::one() + &Number::pi();
    let mut p = Pool::new(Field::for_constants([&one_and_pi]));
    let (n, two) = (p.constant(&one_and_pi), p.integer(2));
    let reciprocal = p.reciprocal(n);
    assert!(!p.is_constant(reciprocal));
    assert_eq!(p.mul(n, reciprocal), ExprId::ONE);
    // 1/(n - 1/n) (n² - 1) - n
    let pivot = p.sub(n, reciprocal);
    let of_pivot = p.reciprocal(pivot);
    let square = p.mul(n, n);
    let rest = p.sub(square, ExprId::ONE);
    let quotient = p.mul(rest, of_pivot);
    assert_eq!(p.sub(quotient, n), ExprId::ZERO);
    let half = p.reciprocal(two);
    assert!(p.is_constant(half));
}

#[test]
fn near_misses_stay_apart() {
    let mut p = pool();
    let (s, c) = (p.symbol(Symbol::Sine(0)), p.symbol(Symbol::Cosine(0)));
    let (s2, c2) = (p.symbol(Symbol::Sine(1)), p.symbol(Symbol::Cosine(1)));
    let (ss, cc) = (p.mul(s, s), p.mul(c2, c2));
    assert_ne!(p.add(ss, cc), ExprId::ONE);
    let (a, b) = (p.mul(s, c2), p.mul(c, s2));
    assert!(!p.equal(a, b));
    // A constant of the size of the prime is not 0: constants are told apart by value.
    let prime = p.field().prime();
    let big = p.constant(&Number::from(crate::exact::Rational::from(prime)));
    assert_ne!(big, ExprId::ZERO);
}

#[test]
fn derivatives_of_the_addition_theorem() {
    let mut p = pool();
    let (s1, c1) = (p.symbol(Symbol::Sine(0)), p.symbol(Symbol::Cosine(0)));
    let (s2, c2) = (p.symbol(Symbol::Sine(1)), p.symbol(Symbol::Cosine(1)));
    let sine = p.dot(&[s1, c1], &[c2, s2]);
    let cosine = p.dot(&[c1, s1], &[c2, -s2]);
    assert_eq!(p.partial_derivative(&[sine, cosine], 1), [cosine, -sine]);
    let rates = [p.symbol(Symbol::Rate(0)), p.symbol(Symbol::Rate(1))];
    let rate = p.add(rates[0], rates[1]);
    let expected = p.mul(cosine, rate);
    assert_eq!(p.time_derivative(&[sine]), [expected]);
    let reciprocal = p.reciprocal(sine);
    let derivative = p.partial_derivative(&[reciprocal], 0)[0];
    let product = p.mul(derivative, sine);
    let back = p.mul(product, sine);
    assert_eq!(back, -cosine);
}

#[test]
fn exact_values_follow_the_identities() {
    let mut p = pool();
    let (s, c, x) = (p.symbol(Symbol::Sine(3)), p.symbol(Symbol::Cosine(3)), p.symbol(Symbol::Position(1)));
    let (sx, half) = (p.mul(s, x), p.fraction(1, 2));
    let sum = p.add(sx, half);
    for number in 0..20 {
        let state = Pool::rational_state(number);
        let v = p.evaluate(&[s, c, x, sum], &state).unwrap();
        assert_eq!(&(&v[0] * &v[0]) + &(&v[1] * &v[1]), Number::one());
        assert_eq!(v[3], &(&v[0] * &v[2]) + &Number::from(crate::exact::Rational::from_parts(1.into(), 2u8.into())));
    }
    let pole = p.reciprocal(s);
    assert_eq!(p.evaluate(&[pole], &|_| Number::zero()), None);
}

#[test]
fn constants_that_are_not_multiplied_out_are_known_by_their_values() {
    let mut p = Pool::new(Field::for_constants([]));
    // R R' = 1 and R (R' R) = R for a product of a dozen rotations by general angles.
    let mut rotation = matrix::IDENTITY;
    for n in 0..12 {
        let angle =
            crate::exact::Angle::new(Number::from(crate::exact::Rational::from(17 + 3 * n) / crate::exact::Rational::from(100)));
        let (s, c) = (p.constant(&angle.sin()), p.constant(&angle.cos()));
        let (zero, one) = (ExprId::ZERO, ExprId::ONE);
        let next = if n % 2 == 0 {
            [[one, zero, zero], [zero, c, -s], [zero, s, c]]
        } else {
            [[c, -s, zero], [s, c, zero], [zero, zero, one]]
        };
        rotation = p.product(&rotation, &next);
    }
    assert!(rotation.iter().flatten().all(|&entry| p.is_constant(entry)));
    assert!(p.as_constant(rotation[0][0]).expect("a constant").is_shared());
    let back = matrix::transpose(&rotation);
    assert_eq!(p.product(&rotation, &back), matrix::IDENTITY);
    let there_and_back = p.product(&back, &rotation);
    assert_eq!(p.product(&rotation, &there_and_back), rotation);
    // Another way to the same value is the same constant, with its sign.
    let [x, y] = [rotation[0][0], rotation[1][2]];
    let (sum, difference) = (p.add(x, y), p.sub(x, y));
    let (product, squares) = (p.mul(sum, difference), [p.mul(x, x), p.mul(y, y)]);
    assert_eq!(p.sub(squares[0], squares[1]), product);
    assert_eq!(p.sub(squares[1], squares[0]), -product);
}

/// The norm of an axis as exporters write it: the root of an integer too long to be factored.
fn norm(component: i64, scale: i64) -> Number {
    let component = Number::from(Rational::from(component) / Rational::from(scale));
    (&Number::one() + &(&component * &component)).sqrt().expect("positive")
}

#[test]
fn roots_of_long_integers_keep_their_relations() {
    let (one, other) = (norm(437_114, 10_000_000_000_000), norm(123, 1_000_000));
    let mut p = Pool::new(Field::for_constants([&one, &other]));
    let inverse = one.inverse().expect("not 0");
    let (x, y, s) = (p.constant(&one), p.constant(&inverse), p.symbol(Symbol::Sine(0)));
    assert_eq!(p.mul(x, y), ExprId::ONE);
    let (xs, square) = (p.mul(x, s), p.constant(&(&one * &one)));
    let (xxs, scaled) = (p.mul(x, xs), p.mul(square, s));
    assert_eq!(xxs, scaled);
    let z = p.constant(&other);
    let product = p.mul(x, z);
    assert_eq!(p.mul(product, product), p.constant(&(&(&one * &one) * &(&other * &other))));
}

#[test]
fn roots_of_integers_with_a_long_common_factor_are_one_constant_however_they_are_written() {
    // 10007 and 10009 are primes beyond trial division: nothing splits the products.
    let root = |n: i64| Number::from(n).sqrt().expect("positive");
    let (left, right, rest) = (root(10_007 * 10_009), root(10_007 * 10_037), root(10_009 * 10_037));
    let mut p = Pool::new(Field::for_constants([&left, &right, &rest]));
    let (a, b) = (p.constant(&left), p.constant(&right));
    let (product, c, common) = (p.mul(a, b), p.constant(&rest), p.integer(10_007));
    assert_eq!(product, p.mul(common, c));
}

#[test]
fn products_of_nested_roots_end() {
    let nested = (&Number::one() + &Number::pi()).sqrt().expect("positive");
    let mut p = Pool::new(Field::for_constants([&nested]));
    let (r, two, s) = (p.constant(&nested), p.integer(2), p.symbol(Symbol::Sine(0)));
    let square = p.mul(r, r);
    let (cube, other) = (p.mul(square, r), p.mul(r, square));
    assert_eq!(cube, other);
    let (double, rs) = (p.mul(two, cube), p.mul(r, s));
    let (left, right) = (p.mul(double, rs), p.mul(rs, double));
    assert_eq!(left, right);
}

#[test]
fn deep_constants_need_no_deep_stack() {
    let work = || {
        let angle = crate::exact::Angle::new(Number::from(Rational::from(7) / Rational::from(10)));
        let step = &Number::from(2) + &(&angle.sin() * &Number::pi());
        let fifth = Number::from(Rational::from(1) / Rational::from(5));
        let mut number = step.clone();
        for _ in 0..3000 {
            number = number.plus(&fifth).times(&step).times(&fifth);
        }
        assert!(number.is_shared() && number.to_f64().is_finite());
        let mut field = Field::for_constants([&number]);
        let value = field.number(&number);
        let doubled = field.number(&number.plus(&number));
        assert_eq!(field.add(value, value), doubled);
        let mut definitions = crate::exact::Definitions::default();
        definitions.formula(&number);
        assert!(definitions.texts().len() > 300, "{}", definitions.texts().len());
        drop((number, field, definitions));
    };
    std::thread::Builder::new().stack_size(1 << 18).spawn(work).expect("a thread").join().expect("no overflow");
}
