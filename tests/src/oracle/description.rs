//! The description, read again: YAML into plain structs of texts, and those into numbers.
//!
//! Only valid files matter here; a wrong file gets any error.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_derive::Deserialize;

use super::{Joint, Model, Motor, Placed, Ten};
use crate::formula::{evaluate, parse, Formula};

/// A number of the file: its text, an expression.
type Text = String;

/// A description as written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Description {
    /// Name of the robot.
    pub name: String,
    convention: String,
    gravity: [Text; 3],
    #[serde(default)]
    parameters: BTreeMap<String, Text>,
    joints: Vec<JointText>,
    base: Option<PoseText>,
    tip: Option<String>,
    tool: Option<PoseText>,
    payload: Option<BodyText>,
    /// Rows of the task, as listed; empty by default.
    #[serde(default)]
    pub task: Vec<String>,
    regressor: Option<RegressorChoice>,
    #[serde(rename = "allow")]
    _allow: Option<IgnoredAnyClone>,
}

/// The regressor that the file requests.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(from = "RegressorText")]
pub enum RegressorChoice {
    /// Ten per link, drives, payload.
    Standard,
    /// A minimal set.
    Base,
    /// Names of parameters, in order.
    Names(Vec<String>),
}

#[derive(Deserialize)]
#[serde(untagged)]
enum RegressorText {
    Word(Word),
    Names(Vec<String>),
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum Word {
    Standard,
    Base,
}

impl From<RegressorText> for RegressorChoice {
    fn from(text: RegressorText) -> Self {
        match text {
            RegressorText::Word(Word::Standard) => RegressorChoice::Standard,
            RegressorText::Word(Word::Base) => RegressorChoice::Base,
            RegressorText::Names(names) => RegressorChoice::Names(names),
        }
    }
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct JointText {
    name: String,
    r#type: String,
    parent: Option<String>,
    mount: Option<PoseText>,
    a: Option<Text>,
    alpha: Option<Text>,
    d: Option<Text>,
    theta: Option<Text>,
    origin: Option<PoseText>,
    axis: Option<[Text; 3]>,
    #[serde(rename = "limits")]
    _limits: Option<IgnoredAnyClone>,
    link: BodyText,
    motor: Option<MotorText>,
    #[serde(default)]
    friction: FrictionText,
    #[serde(default)]
    spring: SpringText,
    armature: Option<Text>,
}

/// Any value.
#[derive(Clone, Debug, Deserialize)]
#[serde(from = "IgnoredAny")]
struct IgnoredAnyClone;

impl From<IgnoredAny> for IgnoredAnyClone {
    fn from(_: IgnoredAny) -> Self {
        IgnoredAnyClone
    }
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyText {
    mass: Option<Text>,
    com: Option<[Text; 3]>,
    #[serde(default)]
    inertia: InertiaText,
    #[serde(default)]
    attached: Vec<AttachedText>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct InertiaText {
    xx: Option<Text>,
    yy: Option<Text>,
    zz: Option<Text>,
    xy: Option<Text>,
    xz: Option<Text>,
    yz: Option<Text>,
    rpy: Option<[Text; 3]>,
    quat: Option<[Text; 4]>,
    axis: Option<[Text; 3]>,
    angle: Option<Text>,
    xyaxes: Option<[Text; 6]>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct AttachedText {
    #[serde(rename = "name")]
    _name: Option<String>,
    origin: Option<PoseText>,
    mass: Option<Text>,
    com: Option<[Text; 3]>,
    #[serde(default)]
    inertia: InertiaText,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MotorText {
    ratio: Option<Text>,
    inertia: Option<Text>,
    mass: Option<Text>,
    position: Option<[Text; 3]>,
    axis: Option<[Text; 3]>,
    viscous: Option<Text>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct FrictionText {
    viscous: Option<Text>,
    coulomb: Option<Text>,
    smooth: Option<Text>,
    offset: Option<Text>,
    cubic: Option<Text>,
    load: Option<Text>,
    #[serde(default)]
    stribeck: StribeckText,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct StribeckText {
    torque: Option<Text>,
    velocity: Option<Text>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct SpringText {
    stiffness: Option<Text>,
    rest: Option<Text>,
}

/// One pose, or several, each in the frame of the one before.
#[derive(Clone, Debug)]
struct PoseText(Vec<OnePose>);

impl<'de> Deserialize<'de> for PoseText {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrMany;
        impl<'de> Visitor<'de> for OneOrMany {
            type Value = PoseText;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a pose or a list of poses")
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<PoseText, A::Error> {
                Ok(PoseText(vec![OnePose::deserialize(MapAccessDeserializer::new(map))?]))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<PoseText, A::Error> {
                Ok(PoseText(Vec::deserialize(SeqAccessDeserializer::new(seq))?))
            }
        }
        // Not an untagged enum: that would ask for numbers as numbers, and lose their digits.
        deserializer.deserialize_any(OneOrMany)
    }
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct OnePose {
    xyz: Option<[Text; 3]>,
    rpy: Option<[Text; 3]>,
    quat: Option<[Text; 4]>,
    axis: Option<[Text; 3]>,
    angle: Option<Text>,
    xyaxes: Option<[Text; 6]>,
}

type Rotation = [[f64; 3]; 3];

const STILL: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn product(a: &Rotation, b: &Rotation) -> Rotation {
    a.map(|row| [0, 1, 2].map(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
}

fn turned(a: &Rotation, v: [f64; 3]) -> [f64; 3] {
    a.map(|row| (0..3).map(|k| row[k] * v[k]).sum())
}

fn transposed(a: &Rotation) -> Rotation {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i]))
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

fn cross([a, b, c]: [f64; 3], [d, e, f]: [f64; 3]) -> [f64; 3] {
    [b * f - c * e, c * d - a * f, a * e - b * d]
}

/// Expressions with the parameters' values at hand.
struct Numbers(BTreeMap<String, f64>);

impl Numbers {
    fn one(&self, text: &str) -> Result<f64, String> {
        evaluate(&parse(text)?, &self.0).map_err(|error| format!("{error} in `{text}`"))
    }

    fn some(&self, text: &Option<Text>) -> Result<Option<f64>, String> {
        text.as_ref().map(|t| self.one(t)).transpose()
    }

    fn three(&self, texts: &Option<[Text; 3]>) -> Result<Option<[f64; 3]>, String> {
        let Some([x, y, z]) = texts else { return Ok(None) };
        Ok(Some([self.one(x)?, self.one(y)?, self.one(z)?]))
    }

    /// The rotation of a pose.
    fn rotation(&self, pose: &OnePose) -> Result<Rotation, String> {
        if let Some(rpy) = self.three(&pose.rpy)? {
            return Ok(roll_pitch_yaw(rpy));
        }
        if let Some([w, x, y, z]) = &pose.quat {
            // v turned is q v q*: its columns by products of vectors, (w² - u²) e + 2 (u·e) u + 2 w u × e.
            let (w, u) = (self.one(w)?, [self.one(x)?, self.one(y)?, self.one(z)?]);
            let square: f64 = u.iter().map(|x| x * x).sum();
            let columns = [0, 1, 2].map(|k| {
                let side = cross(u, STILL[k]);
                [0, 1, 2].map(|i| ((w * w - square) * STILL[k][i] + 2.0 * u[k] * u[i] + 2.0 * w * side[i]) / (w * w + square))
            });
            return Ok(transposed(&columns));
        }
        if let (Some(axis), Some(angle)) = (self.three(&pose.axis)?, &pose.angle) {
            let (u, (s, c)) = (unit(axis), self.one(angle)?.sin_cos());
            let columns = STILL.map(|e| {
                let side = cross(u, e);
                let back = cross(u, side);
                [0, 1, 2].map(|i| e[i] + s * side[i] + (1.0 - c) * back[i])
            });
            return Ok(transposed(&columns));
        }
        if let Some([a, b, c, d, e, f]) = &pose.xyaxes {
            let x = unit([self.one(a)?, self.one(b)?, self.one(c)?]);
            let z = unit(cross(x, [self.one(d)?, self.one(e)?, self.one(f)?]));
            return Ok(transposed(&[x, cross(z, x), z]));
        }
        Ok(STILL)
    }

    fn pose(&self, pose: &Option<PoseText>) -> Result<Placed, String> {
        let list = pose.as_ref().map_or(&[][..], |pose| &pose.0);
        let (mut r, mut p) = (STILL, [0.0; 3]);
        for one in list {
            let step = turned(&r, self.three(&one.xyz)?.unwrap_or_default());
            p = [0, 1, 2].map(|i| p[i] + step[i]);
            r = product(&r, &self.rotation(one)?);
        }
        Ok((r, p))
    }

    /// Rigidly joined bodies, about the origin of the first body's frame.
    fn lumped(&self, body: &BodyText) -> Result<Ten, String> {
        let mut sum = self.ten(&body.mass, &body.com, &body.inertia, (STILL, [0.0; 3]))?;
        for other in &body.attached {
            let ten = self.ten(&other.mass, &other.com, &other.inertia, self.pose(&other.origin)?)?;
            sum = std::array::from_fn(|k| sum[k] + ten[k]);
        }
        Ok(sum)
    }

    /// A body in a frame, about the origin outside of it: I = R I_C R' + m (c·c 1 - c c').
    fn ten(&self, mass: &Option<Text>, com: &Option<[Text; 3]>, inertia: &InertiaText, (r, p): Placed) -> Result<Ten, String> {
        let m = self.some(mass)?.unwrap_or(0.0);
        let step = turned(&r, self.three(com)?.unwrap_or_default());
        let [x, y, z] = [0, 1, 2].map(|i| p[i] + step[i]);
        let element = |text: &Option<Text>| Ok::<f64, String>(self.some(text)?.unwrap_or(0.0));
        let (xy, xz, yz) = (element(&inertia.xy)?, element(&inertia.xz)?, element(&inertia.yz)?);
        let own = [[element(&inertia.xx)?, xy, xz], [xy, element(&inertia.yy)?, yz], [xz, yz, element(&inertia.zz)?]];
        let InertiaText { rpy, quat, axis, angle, xyaxes, .. } = inertia.clone();
        let axes = product(&r, &self.rotation(&OnePose { xyz: None, rpy, quat, axis, angle, xyaxes })?);
        let i = product(&product(&axes, &own), &transposed(&axes));
        Ok([
            m,
            m * x,
            m * y,
            m * z,
            i[0][0] + m * (y * y + z * z),
            i[0][1] - m * x * y,
            i[1][1] + m * (x * x + z * z),
            i[0][2] - m * x * z,
            i[1][2] - m * y * z,
            i[2][2] + m * (x * x + y * y),
        ])
    }
}

impl Description {
    /// Rows of the geometric Jacobian that make up the task: all six by default.
    pub fn task_rows(&self) -> Vec<usize> {
        const ROWS: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];
        let listed = self.task.iter().filter_map(|name| ROWS.iter().position(|row| row == name));
        if self.task.is_empty() {
            (0..6).collect()
        } else {
            listed.collect()
        }
    }

    /// Reads the text of a file.
    pub fn read(text: &str) -> Result<Self, String> {
        serde_yaml::from_str(text).map_err(|error| error.to_string())
    }

    /// The regressor that the file requests; `standard` by default.
    pub fn regressor_choice(&self) -> RegressorChoice {
        self.regressor.clone().unwrap_or(RegressorChoice::Standard)
    }

    /// Values of the parameters as the file gives them.
    pub fn nominal(&self) -> Result<BTreeMap<String, f64>, String> {
        self.values(&[])
    }

    /// Values of the parameters, some of them replaced; one may be written with others, in any order.
    fn values(&self, replaced: &[(&str, f64)]) -> Result<BTreeMap<String, f64>, String> {
        let mut values = BTreeMap::new();
        let mut open: Vec<(&String, Formula)> = Vec::new();
        for (name, text) in &self.parameters {
            match replaced.iter().find(|(other, _)| other == name) {
                Some(&(_, value)) => _ = values.insert(name.clone(), value),
                None => open.push((name, parse(text)?)),
            }
        }
        if let Some((name, _)) = replaced.iter().find(|(name, _)| !values.contains_key(*name)) {
            return Err(format!("`{name}` is no parameter"));
        }
        while !open.is_empty() {
            let before = open.len();
            let mut error = String::new();
            open.retain(|(name, formula)| match evaluate(formula, &values) {
                Ok(value) => {
                    values.insert((*name).clone(), value);
                    false
                }
                Err(e) => {
                    error = format!("parameter `{name}`: {e}");
                    true
                }
            });
            if open.len() == before {
                return Err(error);
            }
        }
        Ok(values)
    }

    /// The arm with the parameters of the file.
    pub fn model(&self) -> Result<Model, String> {
        self.model_with(&[])
    }

    /// The arm with some parameters replaced.
    pub fn model_with(&self, replaced: &[(&str, f64)]) -> Result<Model, String> {
        let numbers = Numbers(self.values(replaced)?);
        let modified = match self.convention.as_str() {
            "standard" => false,
            "modified" => true,
            "urdf" => false,
            other => return Err(format!("unknown convention `{other}`")),
        };
        let joints = self
            .joints
            .iter()
            .enumerate()
            .map(|(i, j)| {
                let on = match j.parent.as_deref() {
                    None => i,
                    Some("base") => 0,
                    Some(parent) => 1 + self.joints[..i].iter().position(|j| j.name == parent).ok_or("no such parent")?,
                };
                let base = if on == 0 { self.base.clone() } else { None };
                let list = [base, j.mount.clone()].into_iter().flatten().flat_map(|pose| pose.0).collect();
                let start = numbers.pose(&Some(PoseText(list)))?;
                joint(j, (on, start), modified, &numbers)
            })
            .collect::<Result<_, String>>()?;
        Ok(Model {
            modified,
            gravity: numbers.three(&Some(self.gravity.clone()))?.unwrap_or_default(),
            tip: match &self.tip {
                None => self.joints.len(),
                Some(tip) => 1 + self.joints.iter().position(|joint| joint.name == *tip).ok_or("no such joint")?,
            },
            joints,
            tool: numbers.pose(&self.tool)?,
            payload: self.payload.as_ref().map(|body| numbers.lumped(body)).transpose()?,
        })
    }
}

/// `on`: the frame that carries the joint; `start`: the frame there that its row starts from.
fn joint(text: &JointText, (on, start): (usize, Placed), modified: bool, numbers: &Numbers) -> Result<Joint, String> {
    let prismatic = match text.r#type.as_str() {
        "revolute" => false,
        "prismatic" => true,
        other => return Err(format!("unknown joint type `{other}`")),
    };
    let number = |text: &Option<Text>| Ok::<f64, String>(numbers.some(text)?.unwrap_or(0.0));
    let row = [number(&text.a)?, number(&text.alpha)?, number(&text.d)?, number(&text.theta)?];
    let origin = match numbers.three(&text.axis)? {
        Some(axis) => Some((numbers.pose(&text.origin)?, unit(axis))),
        None => None,
    };
    // The joint axis in the previous link's frame: its z, tilted by alpha in a modified row.
    let own_axis = match origin {
        Some(((r, _), axis)) => turned(&r, axis),
        None if modified => [0.0, -row[1].sin(), row[1].cos()],
        None => [0.0, 0.0, 1.0],
    };
    let own_axis = turned(&start.0, own_axis);
    let motor = |motor: &MotorText| -> Result<Motor, String> {
        let axis = numbers.three(&motor.axis)?.unwrap_or(own_axis);
        let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        Ok(Motor {
            ratio: numbers.some(&motor.ratio)?.unwrap_or(1.0),
            inertia: numbers.some(&motor.inertia)?,
            mass: numbers.some(&motor.mass)?.unwrap_or(0.0),
            position: numbers.three(&motor.position)?.unwrap_or_default(),
            axis: axis.map(|x| x / length),
            viscous: numbers.some(&motor.viscous)?,
        })
    };
    Ok(Joint {
        prismatic,
        on,
        start,
        row,
        origin,
        link: numbers.lumped(&text.link)?,
        motor: text.motor.as_ref().map(motor).transpose()?,
        viscous: numbers.some(&text.friction.viscous)?,
        coulomb: numbers.some(&text.friction.coulomb)?,
        smooth: numbers.some(&text.friction.smooth)?,
        offset: numbers.some(&text.friction.offset)?,
        cubic: numbers.some(&text.friction.cubic)?,
        load: numbers.some(&text.friction.load)?.unwrap_or(0.0),
        stribeck: numbers.some(&text.friction.stribeck.torque)?,
        stribeck_velocity: numbers.some(&text.friction.stribeck.velocity)?.unwrap_or(1.0),
        stiffness: numbers.some(&text.spring.stiffness)?,
        rest: numbers.some(&text.spring.rest)?.unwrap_or(0.0),
        armature: numbers.some(&text.armature)?,
    })
}

/// R = Rz(yaw) Ry(pitch) Rx(roll).
fn roll_pitch_yaw([roll, pitch, yaw]: [f64; 3]) -> [[f64; 3]; 3] {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}
