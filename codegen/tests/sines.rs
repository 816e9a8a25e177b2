//! The sine and cosine of `--trig fast`, as emitted, against a reference of more than 200 bits, and the reference against another.

#[path = "sines/arguments.rs"]
mod arguments;
#[path = "sines/emitted.rs"]
mod emitted;
#[path = "sines/reference.rs"]
mod reference;

use arguments::{ranges, Range};
use dashu_float::round::mode::HalfEven;
use dashu_float::FBig;
use reference::{Format, Reference, F32, F64};

/// The promise of the documentation.
const PROMISE: f64 = 1.0;
/// Bound of the error analysis in the documentation, f64.
const BOUND: f64 = 0.9;
/// Arguments in each range: `cargo run --release -p armgen-codegen --example sine_errors` takes a million.
const COUNT: usize = 4000;

#[track_caller]
fn check(format: Format, most: f64, (smallest, largest): (f64, f64), sin_cos: impl Fn(f64) -> (f64, f64)) {
    let reference = Reference::new();
    for (name, range) in ranges(smallest, largest) {
        for x in range.arguments(COUNT, largest, format) {
            let ((sine, cosine), (exact_sine, exact_cosine)) = (sin_cos(x), reference.sin_cos(x));
            let errors = (exact_sine.ulps(sine, format), exact_cosine.ulps(cosine, format));
            assert!(errors.0 <= most && errors.1 <= most, "{name}: sine and cosine of {x:e} are {errors:?} ulp off");
        }
    }
}

#[test]
fn sines_in_f64_are_within_an_ulp() {
    check(F64, BOUND, (-1074.0, emitted::f64::RANGE), emitted::f64::one);
}

#[test]
fn sines_in_f32_are_within_an_ulp() {
    check(F32, PROMISE, (-149.0, f64::from(emitted::f32::RANGE)), |x| {
        let (sine, cosine) = emitted::f32::one(x as f32);
        (f64::from(sine), f64::from(cosine))
    });
}

#[test]
fn an_angle_has_the_same_sine_beside_any_others() {
    let angles = [0.3, -2.0, 1e9, 7.0, -0.0, f64::NAN, 65536.0, 12.5];
    let singles = angles.map(|x| x as f32);
    let (double, single) = (emitted::f64::eight(8, angles), emitted::f32::eight(singles));
    let [a, b, c, d, ..] = angles;
    let (double_of_four, single_of_four) =
        (emitted::f64::four(4, [a, b, c, d]), emitted::f32::four([a, b, c, d].map(|x| x as f32)));
    for i in 0..angles.len() {
        let (sine, cosine) = emitted::f64::one(angles[i]);
        let (sine_single, cosine_single) = emitted::f32::one(singles[i]);
        assert_eq!((double.0[i].to_bits(), double.1[i].to_bits()), (sine.to_bits(), cosine.to_bits()));
        assert_eq!((single.0[i].to_bits(), single.1[i].to_bits()), (sine_single.to_bits(), cosine_single.to_bits()));
        if i < 4 {
            assert_eq!((double_of_four.0[i].to_bits(), double_of_four.1[i].to_bits()), (sine.to_bits(), cosine.to_bits()));
            assert_eq!(
                (single_of_four.0[i].to_bits(), single_of_four.1[i].to_bits()),
                (sine_single.to_bits(), cosine_single.to_bits())
            );
        }
    }
}

/// An angle has the same bits by itself, without its cosine or its sine, and together with others.
#[test]
fn an_angle_has_the_same_sine_however_it_is_asked_for() {
    let special = [0.0, emitted::f64::RANGE, 1e9, 1e300];
    let ranges = ranges(-1074.0, emitted::f64::RANGE);
    let all = ranges.iter().flat_map(|(_, range)| range.arguments(COUNT, emitted::f64::RANGE, F64));
    for x in all.chain(special).flat_map(|x| [x, -x]) {
        let bits = |(sine, cosine): (f64, f64)| (sine.to_bits(), cosine.to_bits());
        let pair = bits(emitted::f64::one(x));
        assert_eq!(bits(emitted::f64::each_alone(x)), pair, "{x:e}");
        for lane in 0..8 {
            let mut angles = [0.0, 1.0, 2.0, 4.0, -1.0, -2.0, -4.0, 6.0];
            angles[lane] = x;
            let (sines, cosines) = emitted::f64::eight(8, angles);
            assert_eq!(bits((sines[lane], cosines[lane])), pair, "{x:e}, {lane}");
            let [a, b, c, d, ..] = angles;
            let (sines, cosines) = emitted::f64::four(4, [a, b, c, d]);
            assert!(lane > 3 || bits((sines[lane], cosines[lane])) == pair, "{x:e}, {lane}");
        }
    }
    for x in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let (pair, alone) = (emitted::f64::one(x), emitted::f64::each_alone(x));
        assert!(pair.0.is_nan() && pair.1.is_nan() && alone.0.is_nan() && alone.1.is_nan());
    }
}

/// The same in f32, where an angle by itself is one of a loop of one.
#[test]
fn an_angle_in_f32_has_the_same_sine_in_every_lane() {
    let limit = f64::from(emitted::f32::RANGE);
    let ranges = ranges(-149.0, limit);
    let all = ranges.iter().flat_map(|(_, range)| range.arguments(COUNT, limit, F32));
    for x in all.flat_map(|x| [x as f32, -x as f32]) {
        let (sine, cosine) = emitted::f32::one(x);
        for lane in 0..8 {
            let mut angles = [0.0, 1.0, 2.0, 4.0, -1.0, -2.0, -4.0, 6.0];
            angles[lane] = x;
            let (sines, cosines) = emitted::f32::eight(angles);
            assert_eq!((sines[lane].to_bits(), cosines[lane].to_bits()), (sine.to_bits(), cosine.to_bits()), "{x:e}, {lane}");
        }
        let (sines, cosines) = emitted::f32::four([1.0, 2.0, x, 4.0]);
        assert_eq!((sines[2].to_bits(), cosines[2].to_bits()), (sine.to_bits(), cosine.to_bits()), "{x:e}");
    }
}

/// Angles at which r is next to pi/4, e is largest and all roundings have the same sign, found by a search. The form r - (e + r^3
/// P), without the factor of e, is 0.997 to 0.999996 units off there.
#[test]
fn the_worst_angles_that_a_search_found_are_within_their_bound() {
    let reference = Reference::new();
    for bits in [0x40a9_bd7d_85ee_596b, 0x40df_016e_2061_5552, 0x40be_7e12_81ae_4265, 0x40eb_015e_8309_67de] {
        let x = f64::from_bits(bits);
        let ((sine, cosine), (exact_sine, exact_cosine)) = (emitted::f64::one(x), reference.sin_cos(x));
        let errors = (exact_sine.ulps(sine, F64), exact_cosine.ulps(cosine, F64));
        assert!(errors.0 < BOUND && errors.1 < BOUND, "sine and cosine of {x:e} are {errors:?} ulp off");
    }
}

/// Fewer angles than lanes all have their sines, with or without the last pairs of lanes and with or without an angle beyond the range.
#[test]
fn fewer_angles_than_lanes_have_their_sines() {
    for third in [0.7, 1e9] {
        let angles = [0.3, -2.0, third, 7.0, -0.0, 3.5, 65536.0, 12.5];
        let check = |count: usize, (sines, cosines): (&[f64], &[f64])| {
            for (i, angle) in angles.iter().enumerate().take(count) {
                let (sine, cosine) = emitted::f64::one(*angle);
                assert_eq!((sines[i].to_bits(), cosines[i].to_bits()), (sine.to_bits(), cosine.to_bits()), "{count} {i}");
            }
        };
        for count in 1..=8 {
            let (sines, cosines) = emitted::f64::eight(count, angles);
            check(count, (&sines, &cosines));
        }
        let [a, b, c, d, ..] = angles;
        for count in 1..=4 {
            let (sines, cosines) = emitted::f64::four(count, [a, b, c, d]);
            check(count, (&sines, &cosines));
        }
    }
}

#[test]
fn zeros_keep_their_sign_and_the_smallest_numbers_their_bits() {
    for x in [0.0, -0.0, f64::from_bits(1), -f64::from_bits(1), f64::MIN_POSITIVE] {
        let (sine, cosine) = emitted::f64::one(x);
        assert_eq!((sine.to_bits(), cosine), (x.to_bits(), 1.0));
    }
    for x in [0.0, -0.0, f32::from_bits(1), -f32::from_bits(1), f32::MIN_POSITIVE] {
        let (sine, cosine) = emitted::f32::one(x);
        assert_eq!((sine.to_bits(), cosine), (x.to_bits(), 1.0));
    }
}

/// Samples f32 in fixed steps up to the largest; the example `sine_errors` takes every one.
#[test]
fn sines_in_f32_are_within_an_ulp_for_every_size_of_angle() {
    const STEP: usize = 100_003;
    let reference = Reference::new();
    let beyond = emitted::f32::RANGE.to_bits();
    // The f32 that comes nearest to a multiple of pi/2, and the angles about a power of two, where the bits of 2/pi that count change.
    let special = [16_367_173.0 * 72f32.exp2()].into_iter().chain((7..128).map(|k| (k as f32).exp2().next_down()));
    for x in (1..f32::INFINITY.to_bits()).step_by(STEP).map(f32::from_bits).chain(special) {
        let ((sine, cosine), (exact_sine, exact_cosine)) = (emitted::f32::one(x), reference.sin_cos(x.into()));
        let errors = (exact_sine.ulps(sine.into(), F32), exact_cosine.ulps(cosine.into(), F32));
        assert!(errors.0 <= PROMISE && errors.1 <= PROMISE, "sine and cosine of {x:e} are {errors:?} ulp off");
        if x.to_bits() > beyond {
            assert_eq!(emitted::f32::one(-x), (-sine, cosine), "{x:e}");
        }
    }
    for x in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
        let (sine, cosine) = emitted::f32::one(x);
        assert!(sine.is_nan() && cosine.is_nan());
    }
}

/// The runtime's sines of f32 are the emitted ones: the same text, item by item.
#[test]
fn the_runtime_has_the_same_sines() {
    let emitted = include_str!("../src/emit/rust/sincos/fast_f32.rs");
    let (_, own) = include_str!("../../runtime/src/scalar/sines.rs").split_once("\n\n").expect("documentation comes first");
    let own = own.trim_end().replace("pub(super) ", "");
    assert!(emitted.starts_with(&own) && own.ends_with('}'), "copy the items up to `sin_cos_beyond`");
}

#[test]
fn beyond_the_range_the_answer_in_f64_is_that_of_libm() {
    let above = f64::from_bits(emitted::f64::RANGE.to_bits() + 1);
    for x in [above, -above, 1e22, -f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let ((sine, cosine), expected) = (emitted::f64::one(x), libm::sincos(x));
        assert!(same(sine, expected.0) && same(cosine, expected.1), "{x:e}");
    }
}

fn same(a: f64, b: f64) -> bool {
    a == b || (a.is_nan() && b.is_nan())
}

/// Odd and even as sine and cosine are: bits and signs, not only to rounding.
#[test]
fn a_turn_the_other_way_changes_only_the_sign_of_the_sine() {
    for x in Range::Uniform(emitted::f64::RANGE).arguments(COUNT, emitted::f64::RANGE, F64) {
        let ((s, c), (t, d)) = (emitted::f64::one(x), emitted::f64::one(-x));
        assert_eq!((s, c), (-t, d), "{x:e}");
    }
    let largest = f64::from(emitted::f32::RANGE);
    for x in Range::Uniform(largest).arguments(COUNT, largest, F32) {
        let ((s, c), (t, d)) = (emitted::f32::one(x as f32), emitted::f32::one(-x as f32));
        assert_eq!((s, c), (-t, d), "{x:e}");
    }
}

#[test]
fn the_reference_agrees_with_another_to_200_bits() {
    let reference = Reference::new();
    let format = Format::of_bits(200);
    for x in [1.0, -0.5, 3.0, 22.0, 355.0, 65535.5, 1e-3, -1e-11, 1e-12, 2e-300, std::f64::consts::FRAC_PI_2] {
        let exact = FBig::<HalfEven, 2>::try_from(x).expect("finite").with_precision(240).value();
        let (sine, cosine) = reference.sin_cos(x);
        for (ours, other) in [(sine, exact.sin()), (cosine, exact.cos())] {
            let (mantissa, exponent) = other.repr().clone().into_parts();
            assert!(ours.ulps_of(&mantissa, exponent, format) < 1.0, "{x:e}");
        }
    }
}
