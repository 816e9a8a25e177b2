//! The file that `armgen time --json` writes: path, limits, law and barriers.

use serde_json::Value;

use super::law::Law;

/// The limits of a file.
pub(super) struct Limits {
    pub(super) velocity: Vec<Option<f64>>,
    pub(super) acceleration: Vec<Option<f64>>,
    pub(super) effort: Vec<[Option<f64>; 2]>,
    /// Speed and turn rate of the end effector.
    pub(super) tool: [Option<f64>; 2],
}

/// A barrier of the file.
pub(super) struct Barrier {
    pub(super) law: Law,
    pub(super) direction: i64,
    /// The joint and the limit; of the end effector no joint counts.
    pub(super) row: (usize, Kind),
}

/// A kind of limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    TorqueHigh,
    TorqueLow,
    AccelerationHigh,
    AccelerationLow,
    Speed,
    ToolSpeed,
    ToolTurnRate,
}

impl Kind {
    /// Whether it is a bound of x alone.
    pub(super) fn is_speed(self) -> bool {
        matches!(self, Kind::Speed | Kind::ToolSpeed | Kind::ToolTurnRate)
    }
}

/// Those of the end effector.
pub(super) const TOOL: [(Kind, &str); 2] =
    [(Kind::ToolSpeed, "end effector speed"), (Kind::ToolTurnRate, "end effector turn rate")];

/// Those of each joint.
pub(super) const KINDS: [(Kind, &str); 5] = [
    (Kind::TorqueHigh, "torque high"),
    (Kind::TorqueLow, "torque low"),
    (Kind::AccelerationHigh, "acceleration high"),
    (Kind::AccelerationLow, "acceleration low"),
    (Kind::Speed, "speed"),
];

/// Knots and ends of segments differ by less.
pub(super) const ROUNDING: f64 = 1e-12;

/// The content of a file.
pub(super) struct File {
    pub(super) joints: Vec<String>,
    pub(super) knots: Vec<f64>,
    /// `[piece][joint][power]`.
    pub(super) coefficients: Vec<Vec<Vec<f64>>>,
    /// The share of the limits of speed on each piece.
    pub(super) shares: Vec<f64>,
    /// Knots at which the motion rests.
    pub(super) stops: Vec<f64>,
    /// At both ends.
    pub(super) speed: [f64; 2],
    pub(super) limits: Limits,
    pub(super) s: Vec<f64>,
    pub(super) t: Vec<f64>,
    pub(super) laws: Vec<Law>,
    /// Of each segment: the best one, if there is one, and others that bound x at its ends.
    pub(super) barriers: Vec<Vec<Barrier>>,
    pub(super) duration: f64,
    pub(super) lower_bound: f64,
}

fn at<'a>(value: &'a Value, path: &str) -> Result<&'a Value, String> {
    path.split('.').try_fold(value, |value, key| value.get(key)).ok_or_else(|| format!("`{path}` is missing"))
}

fn number(value: &Value, what: &str) -> Result<f64, String> {
    value.as_f64().filter(|x| x.is_finite()).ok_or_else(|| format!("`{what}` has something other than a number"))
}

fn list<'a>(value: &'a Value, what: &str) -> Result<&'a [Value], String> {
    value.as_array().map(Vec::as_slice).ok_or_else(|| format!("`{what}` is not a list"))
}

fn numbers(value: &Value, what: &str) -> Result<Vec<f64>, String> {
    list(value, what)?.iter().map(|x| number(x, what)).collect()
}

/// Numbers, or null for no limit.
fn optional(value: &Value, what: &str) -> Result<Vec<Option<f64>>, String> {
    list(value, what)?.iter().map(|x| if x.is_null() { Ok(None) } else { number(x, what).map(Some) }).collect()
}

impl File {
    /// All rows, with their names.
    pub(super) fn rows(&self) -> impl Iterator<Item = (usize, Kind, String)> + '_ {
        let of_joint = |(joint, name): (usize, &String)| {
            let name = name.clone();
            KINDS.map(|(kind, text)| (joint, kind, format!("{name} {text}")))
        };
        self.joints.iter().enumerate().flat_map(of_joint).chain(TOOL.map(|(kind, text)| (0, kind, text.to_owned())))
    }

    /// Whether the motion rests at node `i` of the grid.
    pub(super) fn rests(&self, i: usize) -> bool {
        self.stops.iter().any(|stop| (self.s[i] - stop).abs() <= ROUNDING * (1.0 + stop.abs()))
    }

    pub(super) fn read(text: &str) -> Result<File, String> {
        let json: Value = serde_json::from_str(text).map_err(|error| format!("no JSON: {error}"))?;
        let joints: Vec<String> = list(at(&json, "joints")?, "joints")?
            .iter()
            .map(|name| name.as_str().map(str::to_owned).ok_or_else(|| "`joints` has something other than a name".to_owned()))
            .collect::<Result<_, _>>()?;
        let n = joints.len();
        let knots = numbers(at(&json, "path.knots")?, "path.knots")?;
        let mut coefficients = Vec::new();
        for piece in list(at(&json, "path.coefficients")?, "path.coefficients")? {
            let piece = list(piece, "path.coefficients")?;
            coefficients.push(piece.iter().map(|of| numbers(of, "path.coefficients")).collect::<Result<Vec<_>, _>>()?);
        }
        let of_joints = |key: &str| -> Result<Vec<Option<f64>>, String> { optional(at(&json, key)?, key) };
        let effort = list(at(&json, "limits.effort")?, "limits.effort")?;
        let effort = effort.iter().map(|both| optional(both, "limits.effort")).collect::<Result<Vec<_>, _>>()?;
        // Files without these keys have no such limits.
        let given = |key: &str| at(&json, key).ok().map(|of| optional(of, key)).transpose();
        let tool = given("limits.tool")?.unwrap_or_else(|| vec![None; 2]);
        let listed = |key: &str| at(&json, key).ok().map(|of| numbers(of, key)).transpose();
        let shares = listed("path.speed")?.unwrap_or_else(|| vec![1.0; coefficients.len()]);
        let stops = listed("path.stops")?.unwrap_or_default();
        let limits = Limits {
            velocity: of_joints("limits.velocity")?,
            acceleration: of_joints("limits.acceleration")?,
            effort: effort.iter().filter_map(|both| both.as_slice().try_into().ok()).collect(),
            tool: tool.as_slice().try_into().map_err(|_| "`limits.tool` is not a speed and a turn rate".to_owned())?,
        };
        let speed = numbers(at(&json, "ends.speed")?, "ends.speed")?;
        let [s, t, x, k] = ["grid.s", "grid.t", "grid.x", "grid.k"].map(|key| at(&json, key).and_then(|of| numbers(of, key)));
        let (s, t, x, k) = (s?, t?, x?, k?);
        let fits = n > 0
            && knots.len() == coefficients.len() + 1
            && coefficients.iter().all(|piece| piece.len() == n && piece.iter().all(|of| (1..=6).contains(&of.len())))
            && [limits.velocity.len(), limits.acceleration.len(), limits.effort.len()] == [n; 3]
            && shares.len() == coefficients.len()
            && speed.len() == 2
            && s.len() > 1
            && [t.len(), x.len(), k.len() + 1] == [s.len(); 3];
        if !fits {
            return Err("the lengths of its lists do not fit".to_owned());
        }
        let ends = [(s[0], knots[0]), (s[s.len() - 1], knots[knots.len() - 1])];
        let off = |(a, b): (f64, f64)| (a - b).abs() > ROUNDING * (1.0 + b.abs());
        if knots.windows(2).chain(s.windows(2)).any(|pair| pair[0] >= pair[1]) || ends.into_iter().any(off) {
            return Err("`grid.s` does not run from the first knot to the last".to_owned());
        }
        if shares.iter().any(|share| !(*share > 0.0 && *share <= 1.0)) {
            return Err("`path.speed` has something other than shares".to_owned());
        }
        if stops.iter().any(|stop| !knots[1..knots.len() - 1].contains(stop)) {
            return Err("`path.stops` has something other than knots inside the path".to_owned());
        }
        let laws: Vec<Law> = k.iter().enumerate().map(|(i, k)| Law { x: [x[i], x[i + 1]], k: *k }).collect();
        let bound = |key: &str| list(at(&json, &format!("bound.{key}"))?, key).map(<[Value]>::to_vec);
        let (direction, x0, x2, k, row) = (bound("direction")?, bound("x0")?, bound("x2")?, bound("k")?, bound("row")?);
        if [direction.len(), x0.len(), x2.len(), k.len(), row.len()] != [laws.len(); 5] {
            return Err("`bound` has other segments than `grid`".to_owned());
        }
        let barrier = |direction: &Value, [x0, x2, k]: [&Value; 3], row: &Value| -> Result<Barrier, String> {
            let text = row.as_str().unwrap_or_default();
            let named = |(joint, name): (usize, &String)| {
                let kind = text.strip_prefix(name.as_str())?.strip_prefix(' ')?;
                KINDS.iter().find(|(_, of)| *of == kind).map(|(kind, _)| (joint, *kind))
            };
            let of_tool = TOOL.iter().find(|(_, of)| *of == text).map(|(kind, _)| (0, *kind));
            let row = of_tool.or_else(|| joints.iter().enumerate().find_map(named));
            let row = row.ok_or_else(|| format!("there is no limit `{text}`"))?;
            let law = Law { x: [number(x0, "bound.x0")?, number(x2, "bound.x2")?], k: number(k, "bound.k")? };
            let direction = direction.as_i64().ok_or("`bound.direction` has something other than 1, 0 and -1")?;
            Ok(Barrier { law, direction, row })
        };
        let mut barriers: Vec<Vec<Barrier>> = Vec::new();
        for i in 0..laws.len() {
            let best = (!direction[i].is_null()).then(|| barrier(&direction[i], [&x0[i], &x2[i], &k[i]], &row[i]));
            barriers.push(best.transpose()?.into_iter().collect());
        }
        for also in list(at(&json, "bound.also")?, "bound.also")? {
            let [x0, x2, k] = ["x0", "x2", "k"].map(|key| at(also, key));
            let of = barrier(at(also, "direction")?, [x0?, x2?, k?], at(also, "row")?)?;
            let segment = at(also, "segment")?.as_u64().and_then(|i| barriers.get_mut(usize::try_from(i).ok()?));
            segment.ok_or("`bound.also` has a segment that is not there")?.push(of);
        }
        let duration = number(at(&json, "duration")?, "duration")?;
        let lower_bound = number(at(&json, "lower_bound")?, "lower_bound")?;
        let speed = [speed[0], speed[1]];
        Ok(File { joints, knots, coefficients, shares, stops, speed, limits, s, t, laws, barriers, duration, lower_bound })
    }
}
