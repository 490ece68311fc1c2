//! Nodes at a time of an animation: glTF 2.0, section 3.11 and appendix C.

use super::Pose;
use super::data::Data;
use super::document::{Document, Sampler, get};
use crate::mesh::io::scanner::Fault;

/// A value of one node at the time.
enum Change {
    Translation([f64; 3]),
    Rotation([f64; 4]),
    Scale([f64; 3]),
    Weights(Vec<f64>),
}

/// The nodes that an animation moves, each with its value.
pub struct Changes(Vec<(usize, Change)>);

impl Changes {
    /// Reads an animation at a time. Before the first key and after the last it stands still.
    pub fn of(data: &Data, pose: &Pose) -> Result<Changes, Fault> {
        let animations = &data.document.animations;
        let Some(animation) = animations.iter().find(|animation| animation.name == pose.animation) else {
            let names: Vec<&str> = animations.iter().map(|animation| animation.name.as_str()).collect();
            let names = if names.is_empty() { "none".to_string() } else { names.join(", ") };
            return Err(Fault::new(format!(
                "no animation is named {:?}; the file has: {names}",
                pose.animation
            )));
        };
        let mut changes = Vec::new();
        for channel in &animation.channels {
            let Some(node) = channel.target.node else { continue };
            get(&data.document.nodes, node, "node")?;
            let sampler = get(&animation.samplers, channel.sampler, "sampler")?;
            let width = match channel.target.path.as_str() {
                "translation" | "scale" => 3,
                "rotation" => 4,
                "weights" => 1,
                _ => continue,
            };
            let value = value_at(data, sampler, pose.time, width)?;
            changes.push((
                node,
                match (channel.target.path.as_str(), value.first_chunk(), value.first_chunk()) {
                    ("translation", Some(&shift), _) => Change::Translation(shift),
                    ("scale", Some(&scale), _) => Change::Scale(scale),
                    ("rotation", _, Some(&rotation)) => Change::Rotation(unit(rotation)),
                    _ => Change::Weights(value),
                },
            ));
        }
        Ok(Changes(changes))
    }

    /// Moves the nodes.
    pub fn apply(self, document: &mut Document) {
        for (node, change) in self.0 {
            let node = &mut document.nodes[node];
            match change {
                Change::Translation(shift) => node.translation = Some(shift),
                Change::Rotation(rotation) => node.rotation = Some(rotation),
                Change::Scale(scale) => node.scale = Some(scale),
                Change::Weights(weights) => node.weights = Some(weights),
            }
        }
    }
}

/// The value of a sampler at a time; each key holds some elements of `width` numbers.
fn value_at(data: &Data, sampler: &Sampler, time: f64, width: usize) -> Result<Vec<f64>, Fault> {
    let times = data.numbers(sampler.input, 1)?;
    let values = data.numbers(sampler.output, width)?;
    let is_cubic = sampler.interpolation == "CUBICSPLINE";
    let size = values.len() / times.len().max(1) / if is_cubic { 3 } else { 1 };
    if times.is_empty() || size == 0 || (width > 1 && size != width) {
        return Err(Fault::new(
            "an animation has not one value for each of its times; export the file again",
        ));
    }
    // A cubic key has a tangent before and one behind its value.
    let key = |at: usize, part: usize| {
        let start = if is_cubic { (3 * at + part) * size } else { at * size };
        &values[start..start + size]
    };
    let after = times.partition_point(|&key| key <= time).min(times.len() - 1);
    let before = after.saturating_sub(usize::from(times[after] > time));
    let span = times[after] - times[before];
    let share = if span > 0.0 { ((time - times[before]) / span).clamp(0.0, 1.0) } else { 0.0 };
    let (from, to) = (key(before, 1), key(after, 1));
    if sampler.interpolation == "STEP" || share == 0.0 {
        return Ok(from.to_vec());
    }
    if is_cubic {
        let (leaving, arriving) = (key(before, 2), key(after, 0));
        let (s, s2, s3) = (share, share * share, share * share * share);
        let factors =
            [2.0 * s3 - 3.0 * s2 + 1.0, span * (s3 - 2.0 * s2 + s), 3.0 * s2 - 2.0 * s3, span * (s3 - s2)];
        let value = |at: usize| {
            factors[0] * from[at] + factors[1] * leaving[at] + factors[2] * to[at] + factors[3] * arriving[at]
        };
        return Ok((0..size).map(value).collect());
    }
    let (first, second) = if width == 4 { slerp_factors(from, to, share) } else { (1.0 - share, share) };
    Ok(from.iter().zip(to).map(|(from, to)| first * from + second * to).collect())
}

/// Factors of two unit quaternions on the shorter great circle between them.
fn slerp_factors(from: &[f64], to: &[f64], share: f64) -> (f64, f64) {
    let cosine: f64 = from.iter().zip(to).map(|(from, to)| from * to).sum();
    let angle = cosine.abs().min(1.0).acos();
    if angle < 1e-6 {
        return (1.0 - share, share * cosine.signum());
    }
    (((1.0 - share) * angle).sin() / angle.sin(), (share * angle).sin() / angle.sin() * cosine.signum())
}

fn unit(rotation: [f64; 4]) -> [f64; 4] {
    let length = rotation.iter().map(|number| number * number).sum::<f64>().sqrt();
    if length > 0.0 { rotation.map(|number| number / length) } else { [0.0, 0.0, 0.0, 1.0] }
}
