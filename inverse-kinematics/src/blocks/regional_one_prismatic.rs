// Block 6 with one prismatic joint: PRR and RPR. RRP is PRR run backwards.

/// Block 6, first joint prismatic, axes 2 and 3 parallel: p = Tz(q1) A Rz(q2) B Rz(q3) w with B = Tz(d) Tx(a) Rx(0 or pi), axes 1 and 2 not
/// at right angles.
///
/// Two components of the equation across axis 1 and the constant one along axis 2 give the point in the plane of block 4; q1 is what is
/// left. At most 2 solutions; `signs`: bit 0 elbow. Elbow folded onto the shoulder: q2 free. w on axis 3: q3 free.
pub fn regional_slide_elbow(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Branches<3, 4> {
    let mut found = Branches::new();
    let noise = ROUNDING * reach(a, b, w, p);
    let z = b[2][3] + b[2][2] * w[2];
    let (n1, n2) = (p[0] - a[0][3] - a[0][2] * z, p[1] - a[1][3] - a[1][2] * z);
    let over = 1.0 / (a[0][0] * a[1][1] - a[0][1] * a[1][0]);
    let (x, y) = ((a[1][1] * n1 - a[0][1] * n2) * over, (a[0][0] * n2 - a[1][0] * n1) * over);
    let q1 = p[2] - a[2][3] - (a[2][0] * x + a[2][1] * y + a[2][2] * z);
    let miss = elbow(b, w, [x, y], noise, 0.0, |q2, q3, signs, (double, error), free| {
        found.add(Branch { joints: [[q1, 0.0], q2, q3], signs, double, error, free });
    });
    found.missed(miss);
    found
}

/// Block 6, first joint prismatic, normal to axis 2: p = Tz(q1) A Rz(q2) B Rz(q3) w with the third column e of RA normal to z.
///
/// Of the horizontal components that along e is the height of B Rz(q3) w on axis 2, block 1 in q3; that across e is block 1 in q2; q1 is what is
/// left. At most 4 solutions; `signs`: bit 0 q3, bit 1 q2. The point on axis 2: q2 free.
pub fn regional_slide_across(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Branches<3, 4> {
    let mut found = Branches::new();
    let reach = reach(a, b, w, p);
    let noise = ROUNDING * reach;
    let g = point_of_third(b, w);
    let (u, v) = (p[0] - a[0][3], p[1] - a[1][3]);
    // The row of RA across e, which has no third component.
    let k = [0, 1].map(|j: usize| a[0][2] * a[1][j] - a[1][2] * a[0][j]);
    let line = line_and_circle(g[2].kc, g[2].ks, a[0][2] * u + a[1][2] * v - g[2].k0, noise, 0.0);
    found.missed(line.miss);
    for (first, q3) in points(&line) {
        let [x, y, z] = [g[0].at(q3[0], q3[1]), g[1].at(q3[0], q3[1]), g[2].at(q3[0], q3[1])];
        let height = a[0][2] * v - a[1][2] * u;
        let across = line_and_circle(k[0] * x + k[1] * y, k[1] * x - k[0] * y, height, noise, line.error * reach);
        found.missed(across.miss);
        for (second, q2) in points(&across) {
            let reached = transform(a, turn_vector(q2[0], q2[1], [x, y, z]));
            found.add(Branch {
                joints: [[p[2] - reached[2], 0.0], q2, q3],
                signs: first | second << 1,
                double: line.double || across.double,
                error: line.error + across.error,
                free: u32::from(across.free) << 1 | u32::from(line.free) << 2,
            });
        }
    }
    found
}

/// Block 6, first joint prismatic: p = Tz(q1) A Rz(q2) B Rz(q3) w for any frames A, B with axes 1 and 2 not at right angles and axes 2 and 3
/// not parallel.
///
/// The components across axis 1 are two equations in (X, Y, g3): `by_elimination`, then q1. At most 4 solutions; `signs`: the number of
/// q3's root. The point on axis 2: q2 free. The equation in q3 empty: q3 free, without a value.
pub fn regional_slide(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Branches<3, 4> {
    let mut found = Branches::new();
    let noise = ROUNDING * reach(a, b, w, p);
    let rows = [0, 1].map(|i: usize| ([a[i][0], a[i][1], a[i][2]], p[i] - a[i][3]));
    let (free, near) = by_elimination(rows[0], 0.0, rows[1], (b, w), noise, |e| {
        let q1 = p[2] - transform(a, e.point)[2];
        found.add(Branch { joints: [[q1, 0.0], e.q2, e.q3], signs: e.index, double: e.double, error: e.error, free: e.free });
    });
    found.near |= near;
    if free {
        found.add(Branch { joints: [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]], signs: 0, double: false, error: 0.0, free: 7 });
    }
    found
}

/// Block 6, second joint prismatic, axes 1 and 3 parallel: p = Rz(q1) A Tz(q2) B Rz(q3) w with RA RB a turn about z, perhaps after a half turn
/// about x; the slide not normal to axis 1.
///
/// The height gives q2, block 4 in the plane q3 and q1. At most 2 solutions; `signs`: bit 0 elbow. Elbow folded onto the shoulder: q1 free.
/// w on axis 3: q3 free.
pub fn regional_mid_slide_elbow(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Branches<3, 4> {
    let mut found = Branches::new();
    let noise = ROUNDING * reach(a, b, w, p);
    let chain = compose(a, b);
    let q2 = (p[2] - chain[2][3] - chain[2][2] * w[2]) / a[2][2];
    let link = [plus_product(chain[0][3], a[0][2], q2), plus_product(chain[1][3], a[1][2], q2)];
    let (l1, l2) = (length_on_axis(link[0], link[1]), length_on_axis(w[0], w[1]));
    let links = two_links(l1, l2, [p[0], p[1]], noise, 0.0);
    found.missed(links.miss);
    // Directions of both links, in the first joint's frame and in the third one's.
    let ([lx, ly], [wx, wy]) = (direction(link, l1), direction([w[0], w[1]], l2));
    // Most directions are axes.
    let sum = |k: Real, x: Real, l: Real, y: Real| plus_product(plus_product(-0.0, k, x), l, y);
    let free = u32::from(links.shoulder_free) | u32::from(links.elbow_free) << 2;
    for (i, ([c, s], [ce, se])) in links.shoulder.iter().zip(&links.elbow).enumerate().take(links.count) {
        let q1 = [sum(lx, *c, ly, *s), sum(lx, *s, -ly, *c)];
        // The second link's direction, seen from the third joint.
        let (x, y) = (sum(lx, *ce, -ly, *se), sum(lx, *se, ly, *ce));
        let (x, y) = (sum(chain[0][0], x, chain[1][0], y), sum(chain[0][1], x, chain[1][1], y));
        let q3 = [sum(wx, x, wy, y), sum(wx, y, -wy, x)];
        found.add(Branch { joints: [q1, [q2, 0.0], q3], signs: i as u16, double: links.double, error: error_apart(&links), free });
    }
    found
}

/// Block 6, second joint prismatic, normal to axis 1: p = Rz(q1) A Tz(q2) B Rz(q3) w with the third column of RA normal to z.
///
/// The height is free of q1 and q2: block 1 in q3. Then |(A Tz(q2) B Rz(q3) w)_xy| = |p_xy| is a line of direction RA e3 that meets a circle:
/// q2; and q1 by block 2. At most 4 solutions; `signs`: bit 0 q3, bit 1 q2 (0: the longer way). p on axis 1: q1 free.
pub fn regional_mid_slide_across(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Branches<3, 4> {
    let mut found = Branches::new();
    let reach = reach(a, b, w, p);
    let noise = ROUNDING * reach;
    let g = point_of_third(&compose(a, b), w);
    let line = line_and_circle(g[2].kc, g[2].ks, p[2] - g[2].k0, noise, 0.0);
    let slack = noise + line.error * reach;
    found.missed(line.miss);
    let (radius, e) = (length(p[0], p[1]), [a[0][2], a[1][2]]);
    for (first, q3) in points(&line) {
        let (x, y) = (g[0].at(q3[0], q3[1]), g[1].at(q3[0], q3[1]));
        let (along, across) = (x * e[0] + y * e[1], (y * e[0] - x * e[1]).abs());
        let gap = radius - across;
        if !(gap >= -slack) {
            found.missed(-gap);
            continue;
        }
        let double = gap <= slack;
        let half = if double { 0.0 } else { sqrt(gap * (radius + across)) };
        for (second, half) in [half, -half].into_iter().enumerate().take(if double { 1 } else { 2 }) {
            let q2 = half - along;
            let q1 = turn([x + q2 * e[0], y + q2 * e[1]], [p[0], p[1]], noise);
            found.add(Branch {
                joints: [q1.value, [q2, 0.0], q3],
                signs: first | (second as u16) << 1,
                double: line.double || (double && !q1.free),
                error: line.error,
                free: u32::from(q1.free) | u32::from(line.free) << 2,
            });
        }
    }
    found
}

/// Block 6, second joint prismatic: p = Rz(q1) A Tz(q2) B Rz(q3) w for any frames A, B with the slide not normal to axis 1.
///
/// With n = RA e3 and g = A B Rz(q3) w the height gives n3 q2 = Z = p_z - g_z; then (n3 g_x + n1 Z)² + (n3 g_y + n2 Z)² = n3² (p_x² + p_y²):
/// block R with D = 2 in q3, q1 by block 2. At most 4 solutions; `signs`: the number of q3's root. p on axis 1: q1 free. The equation in q3
/// empty: q3 free, without a value.
pub fn regional_mid_slide(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Branches<3, 4> {
    let mut found = Branches::new();
    let noise = ROUNDING * reach(a, b, w, p);
    let n = column(a, 2);
    let g = point_of_third(&compose(a, b), w);
    let z = g[2].combined(-1.0, &g[2], 0.0, p[2]);
    let (u, v) = (g[0].combined(n[2], &z, n[0], 0.0), g[1].combined(n[2], &z, n[1], 0.0));
    let square = n[2] * n[2] * (p[0] * p[0] + p[1] * p[1]);
    let roots = squares(&u, &v, &[], &Affine { k0: square, kc: 0.0, ks: 0.0 });
    found.near = roots.near && roots.count == 0;
    for (i, root) in roots.all.iter().enumerate().take(roots.count) {
        let (c, s) = (root.c, root.s);
        let q1 = turn([u.at(c, s) / n[2], v.at(c, s) / n[2]], [p[0], p[1]], noise);
        let joints = [q1.value, [z.at(c, s) / n[2], 0.0], [c, s]];
        let (double, error) = (root.double && !q1.free, root.error);
        found.add(Branch { joints, signs: i as u16, double, error, free: u32::from(q1.free) });
    }
    if roots.free {
        found.add(Branch { joints: [[1.0, 0.0], [0.0, 0.0], [1.0, 0.0]], signs: 0, double: false, error: 0.0, free: 7 });
    }
    found
}
