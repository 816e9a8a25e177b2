// Block 6 with two or three prismatic joints: PPR, PRP, PPP. RPP is PPR run backwards.

/// Block 6, first and second joint prismatic: p = Tz(q1) A Tz(q2) B Rz(q3) w, the slides not parallel.
///
/// The component along the normal of the slides' plane is block 1 in q3; the others are linear in q1, q2. At most 2 solutions; `signs`: bit 0
/// q3. Nothing about q3 along the normal: q3 free.
pub fn regional_plane_then_turn(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Branches<3, 4> {
    let mut found = Branches::new();
    let noise = ROUNDING * reach(a, b, w, p);
    let n = column(a, 2);
    let g = point_of_third(&compose(a, b), w);
    // e3 × n, which is horizontal.
    let height = g[0].combined(-n[1], &g[1], n[0], 0.0);
    let line = line_and_circle(height.kc, height.ks, n[0] * p[1] - n[1] * p[0] - height.k0, noise, 0.0);
    found.missed(line.miss / length(n[0], n[1]));
    for (sign, q3) in points(&line) {
        let [x, y, z] = [0, 1, 2].map(|i: usize| p[i] - g[i].at(q3[0], q3[1]));
        let q2 = (x * n[0] + y * n[1]) / (n[0] * n[0] + n[1] * n[1]);
        let joints = [[z - q2 * n[2], 0.0], [q2, 0.0], q3];
        found.add(Branch { joints, signs: sign, double: line.double, error: line.error, free: u32::from(line.free) << 2 });
    }
    found
}

/// Block 6, first and third joint prismatic: p = Tz(q1) A Rz(q2) B (w + q3 e3), the slides not parallel for every q2.
///
/// With k the direction of joint 1 seen from joint 2, n that of joint 3, v = A⁻¹ p and h = B w: v - Rz h is a combination of k and Rz n, so
/// 0 = k·((v - Rz h) × Rz n) = (k × v)·Rz n - k·Rz (h × n), block 1 in q2; q3 and q1 are linear. At most 2 solutions; `signs`: bit 0 q2.
/// Slides parallel at the q2 found, and the point met: q1 and q3 free together; not met: none.
pub fn regional_slide_turn_slide(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Branches<3, 4> {
    let mut found = Branches::new();
    let reach = reach(a, b, w, p);
    let noise = ROUNDING * reach;
    let k = [a[2][0], a[2][1], a[2][2]];
    let n = column(b, 2);
    let h = transform(b, w);
    let v = rotate_back(a, minus(p, column(a, 3)));
    let (y, x) = (cross(k, v), cross(h, n));
    // u·Rz(q) x = c (u1 x1 + u2 x2) + s (u2 x1 - u1 x2) + u3 x3
    let line = line_and_circle(
        y[0] * n[0] + y[1] * n[1] - (k[0] * x[0] + k[1] * x[1]),
        y[1] * n[0] - y[0] * n[1] - (k[1] * x[0] - k[0] * x[1]),
        k[2] * x[2] - y[2] * n[2],
        noise,
        0.0,
    );
    found.missed(line.miss);
    for (sign, q2) in points(&line) {
        let direction = turn_vector(q2[0], q2[1], n);
        let rest = minus(v, turn_vector(q2[0], q2[1], h));
        let (along, across) = (dot(k, direction), cross(k, direction));
        let square = dot(across, across);
        let parallel = square <= ROUNDING * ROUNDING;
        let q3 = if parallel { 0.0 } else { dot(cross(k, rest), across) / square };
        if parallel {
            let off = cross(k, rest);
            let off = sqrt(dot(off, off));
            if !(off <= noise) {
                found.missed(off);
                continue;
            }
        }
        found.add(Branch {
            joints: [[dot(k, rest) - q3 * along, 0.0], q2, [q3, 0.0]],
            signs: sign,
            double: line.double,
            error: line.error,
            free: u32::from(line.free) << 1 | if parallel { 5 } else { 0 },
        });
    }
    found
}

/// Block 6, three prismatic joints: p = Tz(q1) A Tz(q2) B (w + q3 e3) with directions that span space: one solution, linear.
pub fn regional_slides(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Branches<3, 4> {
    let mut found = Branches::new();
    let chain = compose(a, b);
    let (n2, n3) = (column(a, 2), column(&chain, 2));
    let rest = minus(p, transform(&chain, w));
    let over = 1.0 / (n2[0] * n3[1] - n2[1] * n3[0]);
    let q2 = (rest[0] * n3[1] - rest[1] * n3[0]) * over;
    let q3 = (n2[0] * rest[1] - n2[1] * rest[0]) * over;
    let q1 = rest[2] - q2 * n2[2] - q3 * n3[2];
    found.add(Branch { joints: [[q1, 0.0], [q2, 0.0], [q3, 0.0]], signs: 0, double: false, error: 0.0, free: 0 });
    found
}
