// A trigonometric polynomial from its values at equal angles.

/// cos(j 15 degrees).
#[inline]
fn cosine_of_15_degrees(j: usize) -> Real {
    const COSINES: [Real; 7] = [
        1.0,
        0.965925826289068286749743199728897368,
        0.866025403784438646763723170752936183,
        0.707106781186547524400844362104849039,
        0.5,
        0.258819045102520762348898837624048328,
        0.0,
    ];
    let j = j % 24;
    let j = if j > 12 { 24 - j } else { j };
    let (i, sign) = if j > 6 { (12 - j, -1.0) } else { (j, 1.0) };
    COSINES.get(i).map_or(0.0, |c| sign * c)
}

/// The orders 0 to N - 1 of a function with the given values at K equal angles, divided by `largest`, and the largest of the orders from N to
/// K/2: of a polynomial of degree N - 1 these should vanish, so they are what rounding has done to it. K is 24 or 12.
fn fourier<const K: usize, const N: usize>(samples: &[Real; K], largest: Real) -> ([Real; N], [Real; N], Real) {
    let (mut a, mut b) = ([0.0; N], [0.0; N]);
    let mut noise: Real = 0.0;
    let step = 24 / K;
    for k in 0..=K / 2 {
        let (mut x, mut y) = (0.0, 0.0);
        for (j, sample) in samples.iter().enumerate() {
            let angle = j * k * step;
            x += sample * cosine_of_15_degrees(angle);
            y += sample * cosine_of_15_degrees(angle + 18);
        }
        let weight = if k == 0 { 1.0 } else { 2.0 } / (K as Real * largest);
        match (a.get_mut(k), b.get_mut(k)) {
            (Some(a), Some(b)) => (*a, *b) = (x * weight, y * weight),
            _ => noise = noise.max((x * weight).abs()).max((y * weight).abs()),
        }
    }
    (a, b, noise)
}
