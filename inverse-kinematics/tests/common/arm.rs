// Arms as constant link transforms, over the scalar of the module that includes this file.

/// T = C0 J1 C1 ... Jn Cn.
#[derive(Clone, Debug)]
pub struct Arm {
    pub c: Vec<Frame>,
    pub prismatic: Vec<bool>,
}

/// Rz(theta) Tz(d) Tx(a) Rx(alpha).
pub fn row(theta: f64, d: f64, a: f64, alpha: f64) -> Frame {
    let exact = |x: f64| if (x - x.round()).abs() < 1e-15 { x.round() } else { x };
    let (ct, st, ca, sa) = (exact(theta.cos()), exact(theta.sin()), exact(alpha.cos()), exact(alpha.sin()));
    [[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0.0, sa, ca, d]].map(|r| r.map(|x| x as Real))
}

impl Arm {
    /// Standard Denavit-Hartenberg rows (theta, d, a, alpha); `prismatic` lists the sliding joints.
    pub fn standard(rows: &[(f64, f64, f64, f64)], prismatic: &[usize]) -> Arm {
        let mut c = vec![IDENTITY];
        c.extend(rows.iter().map(|&(theta, d, a, alpha)| row(theta, d, a, alpha)));
        Arm { c, prismatic: (0..rows.len()).map(|i| prismatic.contains(&i)).collect() }
    }

    pub fn joints(&self) -> usize {
        self.prismatic.len()
    }

    pub fn value(&self, i: usize, q: f64) -> [Real; 2] {
        if self.prismatic[i] {
            [q as Real, 0.0]
        } else {
            [q.cos() as Real, q.sin() as Real]
        }
    }

    /// T for joint values (c, s) or (q, 0).
    pub fn forward(&self, q: &[[Real; 2]]) -> Frame {
        let mut t = self.c[0];
        for i in 0..self.joints() {
            t = compose(&t, &joint_then(self.prismatic[i], q[i], &self.c[i + 1]));
        }
        t
    }

    pub fn at(&self, q: &[f64]) -> Frame {
        let values: Vec<_> = q.iter().enumerate().map(|(i, q)| self.value(i, *q)).collect();
        self.forward(&values)
    }

    /// The longest displacement of a link.
    pub fn length(&self) -> Real {
        self.c.iter().fold(0.0, |m: Real, f| m.max(dot(column(f, 3), column(f, 3)).sqrt()))
    }

    /// Random joint values.
    pub fn posture(&self, random: &mut Random) -> Vec<f64> {
        self.prismatic.iter().map(|p| if *p { random.between(-0.5, 0.5) } else { random.angle() }).collect()
    }
}

/// The largest difference of two joint values, angles by their points.
pub fn apart(x: &[[Real; 2]], y: &[[Real; 2]]) -> Real {
    x.iter().flatten().zip(y.iter().flatten()).fold(0.0, |m: Real, (x, y)| m.max((x - y).abs()))
}

/// The largest difference of two frames' entries.
pub fn defect(f: &Frame, g: &Frame) -> Real {
    f.iter().flatten().zip(g.iter().flatten()).fold(0.0, |m: Real, (x, y)| m.max((x - y).abs()))
}

/// Rx(pi) f⁻¹ Rx(pi): a link as the loop run backwards meets it.
pub fn reversed(f: &Frame) -> Frame {
    let [x, y, z] = inverse(f);
    [[x[0], -x[1], -x[2], x[3]], [-y[0], y[1], y[2], -y[3]], [-z[0], z[1], z[2], -z[3]]]
}

/// The closed loop of an arm and a pose from joint `start` on, forwards or backwards: the joints' numbers, and the links after each.
pub fn arranged<const N: usize>(arm: &Arm, t: &Frame, start: usize, backward: bool) -> ([usize; N], [Frame; N]) {
    let mut links = [IDENTITY; N];
    links.copy_from_slice(&arm.c[1..=N]);
    links[N - 1] = compose(&arm.c[N], &compose(&inverse(t), &arm.c[0]));
    let order: [usize; N] = std::array::from_fn(|i| if backward { (start + N - i) % N } else { (start + i) % N });
    let link = |i: usize| if backward { reversed(&links[(order[i] + N - 1) % N]) } else { links[order[i]] };
    (order, std::array::from_fn(link))
}

/// Joint values in the arm's order.
pub fn in_order<const N: usize>(order: &[usize; N], joints: &[[Real; 2]; N]) -> [[Real; 2]; N] {
    let mut values = [[0.0; 2]; N];
    for (place, value) in order.iter().zip(joints) {
        values[*place] = *value;
    }
    values
}
