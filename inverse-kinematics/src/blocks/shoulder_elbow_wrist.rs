// Seven joints, the first three and the last three of which turn about axes through a point: shoulder S and wrist W, with the elbow between.
//
// One joint is too many for a pose. With the posture the elbow may be turned about the line from S to W: the swivel angle, which is given.
// It is measured from a reference that has a pole only where W is straight below S (Elias, Wen, stereographic angle, 2024):
// k = (e - t) × r, x = k × e normalised, y = e × x, for e the direction from S to W, t = -z and r = y of the base frame.
// The elbow E is the point of axis 4 that is nearest to axis 3: the swivel angle is that of SE about e, from x towards y.

/// The directions x and y across `e` from which the swivel angle of a loop is measured, and the length of k, which vanishes at the pole.
#[inline]
fn swivel_reference(base: &Frame, e: Vector) -> ([Vector; 2], Real) {
    let t = rotate_back(base, [0.0, 0.0, -1.0]);
    let k = cross(minus(e, t), rotate_back(base, [0.0, 1.0, 0.0]));
    let across = cross(k, e);
    let size = sqrt(dot(across, across));
    // At the pole itself no direction is left of it, and squares of what is left fall below the scalar.
    let x = if size > UNIT_ROUNDOFF * UNIT_ROUNDOFF { scaled(across, 1.0 / size) } else { any_across(e) };
    // Rounding of e is large beside k there.
    let bent = minus(x, scaled(e, dot(e, x)));
    let x = scaled(bent, 1.0 / sqrt(dot(bent, bent)));
    ([x, cross(e, x)], size)
}

/// x v.
#[inline]
fn scaled(v: Vector, x: Real) -> Vector {
    [v[0] * x, v[1] * x, v[2] * x]
}

/// A unit vector across a unit vector.
fn any_across(e: Vector) -> Vector {
    let v = if e[0].abs() < 0.5 { cross(e, [1.0, 0.0, 0.0]) } else { cross(e, [0.0, 1.0, 0.0]) };
    scaled(v, 1.0 / sqrt(dot(v, v)))
}

/// The swivel angle of a posture of the arm, rad. `way` as for [`shoulder_elbow_wrist`].
pub fn swivel_angle(way: &Arrangement<7>, q: &[Real; 7]) -> Real {
    let [l1, l2, l3, l4, l5, ..] = way.links;
    let mut values = way.offsets;
    for ([co, so], q) in values.iter_mut().zip(q) {
        let (c, s) = cos_sin(*q);
        (*co, *so) = (c * *co - s * *so, s * *co + c * *so);
    }
    let [q1, q2, q3, q4, ..] = values;
    let seen = |v: Vector| {
        let v = rotate(&l1, turn_vector(q2[0], q2[1], rotate(&l2, turn_vector(q3[0], q3[1], v))));
        turn_vector(q1[0], q1[1], v)
    };
    let elbow = seen(column(&l3, 3));
    let wrist = seen(transform(&l3, turn_vector(q4[0], q4[1], transform(&l4, [0.0, 0.0, l5[2][3]]))));
    let ([x, y], _) = swivel_reference(&way.after, scaled(wrist, 1.0 / sqrt(dot(wrist, wrist))));
    atan2(dot(y, elbow), dot(x, elbow))
}

/// Shoulder, elbow, wrist: J1 L1 ... J7 L7 = 1 with L1, L5 = Tz(d) Rx(alpha), L2, L6 = Rx(beta), L3, L4 = Tz(d) Tx(a) Rx(gamma), read forwards from
/// joint 1; the sines of alpha and beta are not 0.
///
/// W and its distance from S are known from the pose: block 4 gives q4. The triangle of S, E, W, which q4 determines, is turned to where W
/// and the swivel angle have it, by a rotation that block 5 takes apart into q1, q2, q3; what is left of the pose's rotation are q5, q6, q7.
///
/// - `way`: the loop. `t`: the pose. `swivel`: the angle, rad.
/// - At most 8 solutions; `signs`: bit 0 elbow (that of block 4), bit 1 shoulder (the sign of sin q2), bit 2 wrist (the sign of sin q6).
/// - S, E, W in one line: the swivel angle has no meaning; joints 1 to 3 and 5 to 7 are free, of either three the one about that line alone if there is one. W at the shoulder: a continuum, of which none is given.
/// - W below S, at the pole of the reference: `near`, with a swivel angle from any direction.
pub fn shoulder_elbow_wrist(way: &Arrangement<7>, t: &Frame, swivel: Real) -> Branches<7, 8> {
    let mut found = Branches::new();
    let [l1, l2, l3, l4, l5, l6, l7] = way.links_at(t);
    let goal = inverse(&l7);
    let to_wrist = minus(column(&goal, 3), [0.0, 0.0, l1[2][3]]);
    let behind_elbow = transform(&l4, [0.0, 0.0, l5[2][3]]);
    let reach = reach(&l3, &l4, behind_elbow, to_wrist) + extent(&l1);
    let noise = ROUNDING * reach;
    let distance = sqrt(dot(to_wrist, to_wrist));
    if distance <= noise {
        found.continuum = true;
        return found;
    }
    // Across axis 4: from S to the axis, from the axis to W.
    let upper = rotate_back(&l3, column(&l3, 3));
    let along = (upper[2] + behind_elbow[2]).abs();
    let across = sqrt(((distance - along) * (distance + along)).max(0.0));
    let noise_across = if along > 0.0 { noise * (distance + along) / (across + noise) } else { noise };
    let (l1_across, l2_across) = (length(upper[0], upper[1]), length(behind_elbow[0], behind_elbow[1]));
    let links = two_links(l1_across, l2_across, [across, 0.0], noise_across, 0.0);
    let gap = distance - along;
    if !(gap >= -noise) {
        found.missed(-gap);
        return found;
    }
    found.missed(links.miss);
    let e = scaled(to_wrist, 1.0 / distance);
    let ([x, y], pole) = swivel_reference(&way.after, e);
    found.near = pole <= ROUNDING;
    let (c, s) = cos_sin(swivel);
    let across = [c * x[0] + s * y[0], c * x[1] + s * y[1], c * x[2] + s * y[2]];
    let (elbow, third) = (column(&l3, 3), cross(e, across));
    for (first, elbow_turn) in links.elbow.iter().enumerate().take(links.count) {
        let [x, y, _] = turn_vector(elbow_turn[0], elbow_turn[1], upper);
        let q4 = turn([behind_elbow[0], behind_elbow[1]], [x, y], 0.0).value;
        let error = links.error;
        let wrist = transform(&l3, turn_vector(q4[0], q4[1], behind_elbow));
        // The same triangle as it is seen from behind joint 3.
        let f = scaled(wrist, 1.0 / sqrt(dot(wrist, wrist)));
        let bent = minus(elbow, scaled(f, dot(f, elbow)));
        // Once more: of a nearly straight arm little is left.
        let bent = minus(bent, scaled(f, dot(f, bent)));
        let height = sqrt(dot(bent, bent));
        let straight = height <= noise;
        let g = if straight { any_across(f) } else { scaled(bent, 1.0 / height) };
        let h = cross(f, g);
        let entry = |i: usize, j: usize| e[i] * f[j] + across[i] * g[j] + third[i] * h[j];
        let row = |i: usize| [entry(i, 0), entry(i, 1), entry(i, 2), 0.0];
        let turned = [row(0), row(1), row(2)];
        let doubt = error + if straight { 0.0 } else { (noise + error * reach) / height } + ROUNDING / (pole + ROUNDING);
        let rotation = compose(&turned, &compose(&l3, &joint_then(false, q4, &l4)));
        let rest = compose(&inverse(&rotation), &goal);
        let shoulder = three_turns(&turned, [l1[2][2], l1[2][1]], [l2[2][2], l2[2][1]], ROUNDING, doubt);
        let wrist = three_turns(&rest, [l5[2][2], l5[2][1]], [l6[2][2], l6[2][1]], ROUNDING, doubt);
        found.missed(shoulder.miss);
        found.missed(wrist.miss);
        let free = if shoulder.free { 0b101 } else { 0 } | if wrist.free { 0b1010000 } else { 0 };
        // About the line S E W joint 3 turns alone where that is its axis, as joint 5 does.
        let about_line = if l3[0][3] == 0.0 { 0b100 } else { 0b111 } | if l4[0][3] == 0.0 { 0b10000 } else { 0b1110000 };
        let free = free | if straight { about_line } else { 0 } | u32::from(links.elbow_free) << 3;
        for (second, [q1, q2, q3]) in shoulder.turns.iter().enumerate().take(shoulder.count) {
            for (last, [q5, q6, q7]) in wrist.turns.iter().enumerate().take(wrist.count) {
                found.add(Branch {
                    joints: [*q1, *q2, *q3, q4, *q5, *q6, *q7],
                    signs: first as u16 | (second as u16) << 1 | (last as u16) << 2,
                    double: links.double || shoulder.double || wrist.double,
                    error: doubt,
                    free,
                });
            }
        }
    }
    found
}
