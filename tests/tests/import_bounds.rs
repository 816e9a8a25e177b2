//! Compares the bounds that `armgen import` reports for its snapping with the true differences. The oracle evaluates both arms,
//! digit by digit and snapped, at random states of the box. A difference never exceeds its bound, and a bound is at most a fixed
//! multiple of the largest difference.

use std::fmt::Write;

use armgen_import::{import, Options};
use armgen_tests::oracle::{Description, Model};
use armgen_tests::random::Random;

/// Largest allowed ratio of bound to difference, for positions, orientations and torques. The bound of a torque assumes that
/// every joint moves at its largest velocity in the worst direction.
const IDLE: [f64; 3] = [10.0, 10.0, 500.0];
const STATES: usize = 600;

/// A URDF of an arm whose angles and axes have four to six decimals.
fn urdf(random: &mut Random) -> String {
    let mut text = "<robot name='arm'><link name='l0'/>".to_owned();
    let joints = random.whole(2, 7);
    let rounded = |random: &mut Random| {
        let decimals = random.whole(4, 6) as usize;
        format!("{:.decimals$}", random.whole(-2, 2) as f64 * std::f64::consts::FRAC_PI_2)
    };
    for j in 1..=joints {
        let slide = random.chance(15);
        let length = |random: &mut Random| if random.chance(40) { 0.0 } else { random.real(-0.4, 0.4) };
        let [x, y, z] = [(); 3].map(|()| length(random));
        let rpy = [(); 3].map(|()| if random.chance(50) { "0".to_owned() } else { rounded(random) }).join(" ");
        let axis = if random.chance(20) { "0.70711 0 -0.7071" } else { "0 0 1" };
        let kind = if slide { "prismatic" } else { "revolute" };
        let limit = if slide { random.real(0.1, 1.0) } else { random.real(1.0, 3.1) };
        let velocity = if slide { random.real(0.2, 1.0) } else { random.real(1.0, 4.0) };
        let mass = random.real(0.3, 8.0);
        let [a, b, c] = [(); 3].map(|()| random.real(-0.1, 0.1));
        let [e, f, g] = [(); 3].map(|()| mass * random.real(1e-3, 1e-2));
        // Σ-born: moments b + c, a + c, a + b of a diagonal Σ.
        let (xx, yy, zz) = (f + g, e + g, e + f);
        write!(
            text,
            "<link name='l{j}'><inertial><origin xyz='{a:.4} {b:.4} {c:.4}' rpy='{}'/><mass value='{mass:.3}'/>\
             <inertia ixx='{xx:.6}' iyy='{yy:.6}' izz='{zz:.6}' ixy='0' ixz='0' iyz='0'/></inertial></link>\
             <joint name='j{j}' type='{kind}'><parent link='l{}'/><child link='l{j}'/><origin xyz='{x:.4} {y:.4} {z:.4}' rpy='{rpy}'/>\
             <axis xyz='{axis}'/><limit lower='-{limit:.2}' upper='{limit:.2}' velocity='{velocity:.2}' effort='9'/></joint>",
            if random.chance(70) { "0 0 0".to_owned() } else { format!("{} 0 0", rounded(random)) },
            j - 1
        )
        .expect("a text takes it");
    }
    text + "</robot>"
}

/// The arm of a file in the oracle, the bounds, and q and |dq| of the box.
struct Read {
    model: Model,
    bound: [f64; 3],
    limits: Vec<[f64; 2]>,
}

#[track_caller]
fn read(text: &str, snap: f64) -> Read {
    let source = armgen_codegen::source::Source::new("arm.urdf", text);
    let (imported, diagnostics) = import(&source, &Options { snap, ..Options::default() });
    let imported =
        imported.unwrap_or_else(|| panic!("{}", diagnostics.render(&source, armgen_codegen::diagnostic::Colour::Never)));
    let model = Description::read(&imported.yaml).and_then(|description| description.model());
    let report: serde_json::Value = serde_json::from_str(&imported.report.to_json()).expect("JSON");
    let of = |key: &str| report["bound"][key].as_f64().expect("a bound");
    let limits = text.split("<limit ").skip(1).map(|limit| {
        ["upper='", "velocity='"].map(|key| {
            let rest = limit.split_once(key).expect("a limit").1;
            rest.split('\'').next().and_then(|number| number.parse().ok()).expect("a number")
        })
    });
    Read {
        model: model.unwrap_or_else(|error| panic!("{error}\n{}", imported.yaml)),
        bound: ["flange", "orientation", "torque"].map(of),
        limits: limits.collect(),
    }
}

/// How far two arms are apart at a state: end effector, m; its axes, rad; a torque, N m or N.
fn apart(a: &Model, b: &Model, [q, dq, ddq]: [&[f64]; 3]) -> [f64; 3] {
    let [ta, tb] = [a, b].map(|arm| arm.direct_kinematics(q));
    let squares = |rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| -> f64 {
        rows.flat_map(|i| columns.clone().map(move |j| (i, j))).map(|(i, j)| (ta[i][j] - tb[i][j]).powi(2)).sum()
    };
    // |R - R'| of Frobenius is 2 sqrt(2) sin(angle / 2).
    let angle = 2.0 * (squares(0..3, 0..3).sqrt() / 8f64.sqrt()).asin();
    let torques = [a, b].map(|arm| arm.inverse_dynamics(q, dq, ddq));
    let torque = torques[0].iter().zip(&torques[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    [squares(0..3, 3..4).sqrt(), angle, torque]
}

/// The largest of |bound| / |what occurs|, of an arm in which the snapping moves something.
#[track_caller]
fn judged(text: &str, random: &mut Random) -> [f64; 3] {
    let (snapped, exact) = (read(text, Options::SNAP), read(text, 0.0));
    let mut worst = [0.0; 3];
    for _ in 0..STATES {
        let mut within = |k: usize| -> Vec<f64> { snapped.limits.iter().map(|box_| random.real(-box_[k], box_[k])).collect() };
        let (q, dq) = (within(0), within(1));
        let ddq: Vec<f64> = q.iter().map(|_| random.real(-10.0, 10.0)).collect();
        let now = apart(&snapped.model, &exact.model, [&q, &dq, &ddq]);
        for (k, now) in now.into_iter().enumerate() {
            // Rounding of the oracle: some units in the last place of metres, radians and of a hundred N m.
            let rounding = [1e-14, 1e-14, 1e-11][k];
            assert!(now <= snapped.bound[k] + rounding, "{k}: {now:e}, but the bound is {:e}\n{text}", snapped.bound[k]);
            worst[k] = f64::max(worst[k], now);
        }
    }
    std::array::from_fn(|k| if worst[k] > 1e-9 { snapped.bound[k] / worst[k] } else { 0.0 })
}

#[test]
#[ignore = "wide"]
fn bounds_are_never_exceeded_and_never_idle() {
    let mut random = Random::new(7);
    let mut largest = [0.0; 3];
    for arm in 0..20 {
        let text = urdf(&mut random);
        let factors = judged(&text, &mut random);
        for k in 0..3 {
            assert!(factors[k] <= IDLE[k], "arm {arm}, {k}: {:.0} times what occurs\n{text}", factors[k]);
            largest[k] = f64::max(largest[k], factors[k]);
        }
    }
    assert!(largest.iter().all(|&factor| factor > 1.0), "nothing was moved: {largest:?}");
    println!("largest factors: {largest:?}");
}

/// A wrist whose last roll is rounded: its light hand hardly moves where it turns, so that a force seen from the hand alone would be far too large.
#[test]
fn a_turn_of_the_hand_is_felt_by_the_hand() {
    let mut random = Random::new(8);
    let mut text = "<robot name='arm'><link name='l0'/>".to_owned();
    for (j, (xyz, rpy, mass)) in [
        ("0 0 0.3", "0 0 0", 5.0),
        ("0.08 0.05 0.24", "-1.5707963268 1.5707963268 0", 4.5),
        ("0 -0.14 0.14", "1.5707963268 0 0", 1.7),
        ("0 -0.04 0.26", "-1.5707963268 0 0", 2.5),
        ("0 -0.12 -0.13", "1.5707963268 0 0", 1.0),
        ("0 0.03 0.28", "-1.5707963268 0 0", 1.5),
        ("0 -0.11 0.1", "-1.5707963268 -0.17453 3.1416", 0.3),
    ]
    .iter()
    .enumerate()
    {
        write!(
            text,
            "<link name='l{}'><inertial><origin xyz='0 0.008 -0.005'/><mass value='{mass}'/>\
             <inertia ixx='0.0003' iyy='0.0003' izz='0.0003' ixy='0' ixz='0' iyz='0'/></inertial></link>\
             <joint name='j{j}' type='revolute'><parent link='l{j}'/><child link='l{}'/><origin xyz='{xyz}' rpy='{rpy}'/>\
             <axis xyz='0 0 1'/><limit lower='-3' upper='3' velocity='3.5' effort='9'/></joint>",
            j + 1,
            j + 1
        )
        .expect("a text takes it");
    }
    text += "</robot>";
    let factors = judged(&text, &mut random);
    println!("{factors:?}");
    assert!(factors[2] <= IDLE[2], "{factors:?}");
}
