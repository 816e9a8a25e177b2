//! Equations for the joint variables at a pose, as polynomials in (1, c, s) of each revolute and (1, d, d²) of each prismatic joint.
//!
//! Consider the last axis of the loop, with a point p on it and its direction l. Expressed from both sides of the first joints, it gives
//! fourteen equations (Raghavan, Roth 1993), in every arrangement whose last joint is revolute. Elimination removes the products of the first
//! joints' variables. Equations of degree 2 still express that these are products, and that their variables are points of the circle. The
//! result has exactly the solutions of the loop: the first joints are linear functions of the others, and the last joint is the remaining
//! rotation.

use super::chain::Chain;
use super::modular::{Frame, Modulus};
use super::polynomials::{product as product_of, sum as sum_of, Polynomial};

/// Equations for some joints of an arm; these joints determine the others.
#[derive(Clone, Debug)]
pub(super) struct System {
    /// Whether each joint is prismatic.
    pub(super) slides: Vec<bool>,
    pub(super) equations: Vec<Polynomial>,
}

/// Sample points of a function of (1, c, s) or (1, d, d²).
fn points(m: Modulus, slides: bool) -> [[u64; 2]; 3] {
    let (l, minus) = (m.one, m.negated(m.one));
    if slides {
        [[0, 0], [l, 0], [minus, 0]]
    } else {
        [[l, 0], [minus, 0], [0, l]]
    }
}

/// Coefficients from the values at all combinations of sample points, with the first place varying slowest.
fn interpolated(m: Modulus, slides: &[bool], mut values: Vec<u64>) -> Vec<u64> {
    let half = m.inverse(m.integer(2));
    let mut stride = values.len();
    for slides in slides {
        stride /= 3;
        for block in values.chunks_mut(3 * stride) {
            for i in 0..stride {
                let [x, y, z] = [block[i], block[i + stride], block[i + 2 * stride]];
                let of = if *slides {
                    let (plus, minus) = (m.times(half, m.plus(y, z)), m.times(half, m.minus(y, z)));
                    [x, minus, m.minus(plus, x)]
                } else {
                    let (plus, minus) = (m.times(half, m.plus(x, y)), m.times(half, m.minus(x, y)));
                    [plus, minus, m.minus(z, plus)]
                };
                for (k, value) in of.into_iter().enumerate() {
                    block[i + k * stride] = value;
                }
            }
        }
    }
    values
}

/// The number `index` in base 3.
fn digits(mut index: usize, places: usize) -> Vec<u8> {
    let mut digits = vec![0; places];
    for digit in digits.iter_mut().rev() {
        *digit = (index % 3) as u8;
        index /= 3;
    }
    digits
}

fn polynomial(places: usize, coefficients: &[u64], degree: u8) -> Polynomial {
    let terms = coefficients.iter().enumerate().filter(|(_, c)| **c != 0);
    Polynomial { terms: terms.map(|(i, c)| (digits(i, places), *c)).collect(), degree }
}

/// Values of a function at all combinations of sample points, in a list per entry.
fn sampled<const N: usize>(m: Modulus, slides: &[bool], f: impl Fn(&[[u64; 2]]) -> [u64; N]) -> [Vec<u64>; N] {
    let count = 3usize.pow(slides.len() as u32);
    let mut values = [(); N].map(|()| Vec::with_capacity(count));
    for index in 0..count {
        let at: Vec<[u64; 2]> = digits(index, slides.len())
            .iter()
            .zip(slides)
            .map(|(digit, slides)| points(m, *slides)[usize::from(*digit)])
            .collect();
        for (list, value) in values.iter_mut().zip(f(&at)) {
            list.push(value);
        }
    }
    values.map(|values| interpolated(m, slides, values))
}

/// p, l, p × l, (p·p) l - 2 (p·l) p, p·p, p·l.
fn of_line(m: Modulus, p: [u64; 3], l: [u64; 3]) -> [u64; 14] {
    let (pp, pl, moment) = (m.dot(p, p), m.dot(p, l), m.cross(p, l));
    let twice = m.plus(pl, pl);
    let mixed: [u64; 3] = std::array::from_fn(|i| m.minus(m.times(pp, l[i]), m.times(twice, p[i])));
    let mut all = [0; 14];
    for (k, vector) in [p, l, moment, mixed].into_iter().enumerate() {
        all[3 * k..3 * k + 3].copy_from_slice(&vector);
    }
    (all[12], all[13]) = (pp, pl);
    all
}

/// Prismatic joints only: the entries of the pose are linear in them.
fn of_slides(chain: &Chain, pose: &Frame) -> System {
    let m = chain.modulus;
    let entries = sampled::<12>(m, &chain.slides, |at| {
        let reached = chain.pose(at);
        std::array::from_fn(|i| m.minus(reached[i / 4][i % 4], pose[i / 4][i % 4]))
    });
    let mut equations = entries.map(|coefficients| polynomial(chain.joints(), &coefficients, 1)).to_vec();
    equations.retain(|equation| !equation.terms.is_empty());
    System { slides: chain.slides.clone(), equations }
}

/// The equations of the loop that starts at `start`. Elimination removes its first joints (two of six, zero of one, otherwise one) and the last
/// one, which has to be revolute. For a point as the target, which has no rotation, it removes only the first joint. `None` if the products of
/// the first joints' variables are not determined.
pub(super) fn of_loop(chain: &Chain, pose: &Frame, start: usize, point: bool) -> Option<System> {
    if !point && chain.slides.iter().all(|slides| *slides) {
        return Some(of_slides(chain, pose));
    }
    let m = chain.modulus;
    let n = chain.joints();
    let joint = |place: usize| (start + place) % n;
    let first = match n {
        6 => 2,
        1 => 0,
        _ => 1,
    };
    let last = if point { n } else { n - 1 };
    if last < first || (!point && chain.slides[joint(n - 1)]) {
        return None;
    }
    let closing = m.compose(&m.compose(&chain.links[n], &m.inverse_frame(pose)), &chain.links[0]);
    let link = |place: usize| if joint(place) == n - 1 { closing } else { chain.links[joint(place) + 1] };
    let moved = |place: usize, value: [u64; 2]| m.joint(chain.slides[joint(place)], chain.axes[joint(place)], value);
    let slides = |from: usize, to: usize| -> Vec<bool> { (from..to).map(|place| chain.slides[joint(place)]).collect() };
    // The last axis in a frame: the line that all rotations about it preserve. For a point: the point.
    let direction = chain.axes[joint(n - 1)];
    let line = |f: &Frame| {
        let p = [f[0][3], f[1][3], f[2][3]];
        let l = f.map(|row| m.dot([row[0], row[1], row[2]], direction));
        of_line(m, p, if point { [0; 3] } else { l })
    };
    let all = |from: usize, at: &[[u64; 2]]| {
        let steps = at.iter().enumerate().map(|(i, value)| m.compose(&moved(from + i, *value), &link(from + i)));
        steps.reduce(|f, g| m.compose(&f, &g)).unwrap_or(m.identity())
    };
    // A point is seen from the base: the loop begins there, and is open after the last joint.
    let (left_slides, right_slides) = (slides(first, last), slides(0, first));
    let left = sampled::<14>(m, &left_slides, |at| {
        let chain_of = all(first, at);
        line(&if point { m.compose(&m.compose(&chain_of, &m.inverse_frame(&closing)), &chain.links[n]) } else { chain_of })
    });
    let right = sampled::<14>(m, &right_slides, |at| {
        let both = all(0, at);
        line(&if point {
            m.compose(&m.inverse_frame(&m.compose(&chain.links[0], &both)), pose)
        } else {
            m.inverse_frame(&m.compose(&link(n - 1), &both))
        })
    });
    // 0 = right - left: first the columns of products, then those of the other joints with the constant.
    let products = right[0].len() - 1;
    let mut rows: Vec<Vec<u64>> = (0..14)
        .map(|k| {
            let mut row = right[k][1..].to_vec();
            row.extend(left[k].iter().map(|x| m.negated(*x)));
            row[products] = m.plus(row[products], right[k][0]);
            row
        })
        .collect();
    for column in 0..products {
        let pivot = (column..14).find(|r| rows[*r][column] != 0)?;
        rows.swap(column, pivot);
        let over = m.inverse(rows[column][column]);
        rows[column].iter_mut().for_each(|x| *x = m.times(*x, over));
        let pivot = rows[column].clone();
        for (r, row) in rows.iter_mut().enumerate() {
            if r != column && row[column] != 0 {
                let factor = m.negated(row[column]);
                m.add_multiple(row, factor, &pivot);
            }
        }
    }
    let places = left_slides.len();
    let mut equations: Vec<Polynomial> = rows[products..].iter().map(|row| polynomial(places, &row[products..], 1)).collect();
    equations.retain(|equation| !equation.terms.is_empty());
    // Product number k as a polynomial in the other joints.
    let product = |k: usize| -> Polynomial {
        match k {
            0 => Polynomial { terms: vec![(vec![0; places], m.one)], degree: 1 },
            k => polynomial(places, &rows[k - 1][products..].iter().map(|x| m.negated(*x)).collect::<Vec<_>>(), 1),
        }
    };
    let times = |x: usize, y: usize| product_of(m, &left_slides, &product(x), &product(y));
    let sum = |x: Polynomial, y: Polynomial, sign: bool| sum_of(m, x, y, sign);
    if first == 2 {
        for (i, j) in [(1, 1), (1, 2), (2, 1), (2, 2)] {
            equations.push(sum(times(3 * i + j, 0), times(3 * i, j), true));
        }
    }
    for (place, slides) in right_slides.iter().enumerate() {
        let step = if place + 1 == first { 1 } else { 3 };
        let squared = times(step, step);
        equations.push(if *slides {
            sum(times(2 * step, 0), squared, true)
        } else {
            sum(sum(squared, times(2 * step, 2 * step), false), times(0, 0), true)
        });
    }
    Some(System { slides: left_slides, equations })
}
