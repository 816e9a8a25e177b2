//! The description, read again: YAML into plain structs of texts, and those into numbers.
//!
//! Only what is valid is of interest here; a wrong file gets some error.

use std::collections::BTreeMap;

use serde::de::IgnoredAny;
use serde_derive::Deserialize;

use super::{Joint, Model, Motor, Ten};
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
    #[serde(default)]
    tool: ToolText,
    payload: Option<BodyText>,
    /// Rows of the task, as listed; none if the file does not say.
    #[serde(default)]
    pub task: Vec<String>,
    regressor: Option<RegressorChoice>,
}

/// What the file wants as regressor.
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
    #[serde(rename = "name")]
    _name: String,
    r#type: String,
    a: Text,
    alpha: Text,
    d: Text,
    theta: Text,
    #[serde(rename = "limits")]
    _limits: Option<IgnoredAnyClone>,
    link: BodyText,
    motor: Option<MotorText>,
    #[serde(default)]
    friction: FrictionText,
}

/// Whatever stands there.
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
    inertia: BTreeMap<String, Text>,
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
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct ToolText {
    xyz: Option<[Text; 3]>,
    rpy: Option<[Text; 3]>,
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

    /// A body about its frame's origin: I = I_C + m (c·c 1 - c c').
    fn body(&self, body: &BodyText) -> Result<Ten, String> {
        let m = self.some(&body.mass)?.unwrap_or(0.0);
        let [x, y, z] = self.three(&body.com)?.unwrap_or_default();
        if let Some(key) = body.inertia.keys().find(|key| !["xx", "yy", "zz", "xy", "xz", "yz"].contains(&key.as_str())) {
            return Err(format!("unknown element `{key}` of an inertia"));
        }
        let about_com = |key: &str| body.inertia.get(key).map_or(Ok(0.0), |text| self.one(text));
        Ok([
            m,
            m * x,
            m * y,
            m * z,
            about_com("xx")? + m * (y * y + z * z),
            about_com("xy")? - m * x * y,
            about_com("yy")? + m * (x * x + z * z),
            about_com("xz")? - m * x * z,
            about_com("yz")? - m * y * z,
            about_com("zz")? + m * (x * x + y * y),
        ])
    }
}

impl Description {
    /// Rows of the geometric Jacobian that make up the task: all six if the file does not say.
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

    /// What the file wants as regressor; `standard` if it does not say.
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
            other => return Err(format!("unknown convention `{other}`")),
        };
        let joints = self.joints.iter().map(|j| joint(j, modified, &numbers)).collect::<Result<_, String>>()?;
        let rpy = numbers.three(&self.tool.rpy)?.unwrap_or_default();
        Ok(Model {
            modified,
            gravity: numbers.three(&Some(self.gravity.clone()))?.unwrap_or_default(),
            joints,
            tool: (roll_pitch_yaw(rpy), numbers.three(&self.tool.xyz)?.unwrap_or_default()),
            payload: self.payload.as_ref().map(|body| numbers.body(body)).transpose()?,
        })
    }
}

fn joint(text: &JointText, modified: bool, numbers: &Numbers) -> Result<Joint, String> {
    let prismatic = match text.r#type.as_str() {
        "revolute" => false,
        "prismatic" => true,
        other => return Err(format!("unknown joint type `{other}`")),
    };
    let row = [numbers.one(&text.a)?, numbers.one(&text.alpha)?, numbers.one(&text.d)?, numbers.one(&text.theta)?];
    // The joint axis in the previous link's frame: its z, tilted by alpha in a modified row.
    let own_axis = if modified { [0.0, -row[1].sin(), row[1].cos()] } else { [0.0, 0.0, 1.0] };
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
        row,
        link: numbers.body(&text.link)?,
        motor: text.motor.as_ref().map(motor).transpose()?,
        viscous: numbers.some(&text.friction.viscous)?,
        coulomb: numbers.some(&text.friction.coulomb)?,
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
