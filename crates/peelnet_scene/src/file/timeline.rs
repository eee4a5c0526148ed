//! `[[timeline]]`: the states of a scene that changes over time, and its objects at one time.

use super::{
    loader::Loader,
    raw::{RawObject, RawState},
};
use crate::{
    budget::{self, MAX_CHANGES},
    error::SceneError,
    material::Material,
};
use peelnet_core::files::printable;
use std::collections::{HashMap, HashSet};

pub(super) const NO_TIMELINE: &str = "is missing: leave the time out, or add [[timeline]] states";

/// The objects of a scene at one time of its timeline.
#[derive(Default)]
pub(super) struct Snapshot {
    pub time: f32,
    /// The objects as they are, and as they are at the next state's time; no next ones without a timeline.
    pub objects: Vec<RawObject>,
    pub next: Vec<RawObject>,
    /// How far the time is on its way to the next state, 0 … 1.
    pub share: f32,
}

impl Snapshot {
    /// Checks all states, and takes the snapshot at a time, the first state's if there is none.
    pub fn of(
        loader: &mut Loader<'_>,
        mut objects: Vec<RawObject>,
        states: &[RawState],
        time: Option<f32>,
    ) -> Result<Self, SceneError> {
        let (Some(first), Some(last)) = (states.first(), states.last()) else {
            if time.is_some() {
                return Err(loader.value("timeline", NO_TIMELINE));
            }
            return Ok(Self {
                objects,
                ..Self::default()
            });
        };
        for (i, state) in states.iter().enumerate() {
            let is_later = i == 0 || states[i - 1].time < state.time;
            if !(state.time.is_finite() && is_later) {
                let field = format!("timeline {}.time", i + 1);
                let message = "must be finite and later than the state before it";
                return Err(loader.value(&field, message));
            }
        }
        let time = time.unwrap_or(first.time);
        if !(first.time..=last.time).contains(&time) {
            let message = format!("runs from {} to {}, not to {time}", first.time, last.time);
            return Err(loader.value("timeline", message));
        }
        let shown = states.iter().rposition(|s| s.time <= time).unwrap_or(0);
        let next = states.get(shown + 1).map_or(f32::INFINITY, |s| s.time);
        let mut snapshot = Self {
            time,
            share: (time - states[shown].time) / (next - states[shown].time),
            ..Self::default()
        };
        let mut numbers: HashMap<String, Vec<usize>> = HashMap::new();
        for (i, object) in objects.iter().enumerate() {
            if let Some(name) = &object.name {
                numbers.entry(name.clone()).or_default().push(i);
            }
        }
        let changes = states.iter().flat_map(|state| &state.object);
        let changed = changes.filter_map(|change| numbers.get(&change.name));
        let count = changed.map(|objects| objects.len() as u64).sum();
        budget::check(count, MAX_CHANGES, "changes of objects")
            .map_err(|e| loader.value("timeline", e))?;
        let any = Material::default_with(loader.files.lighting);
        for (i, state) in states.iter().enumerate() {
            let field = format!("timeline {}", i + 1);
            let mut named = HashSet::new();
            for change in &state.object {
                if !named.insert(&change.name) {
                    let message = format!("names '{}' twice", printable(&change.name));
                    return Err(loader.value(&format!("{field}.object.name"), message));
                }
                let Some(numbers) = numbers.get(&change.name) else {
                    let message = format!("no [[object]] is named '{}'", printable(&change.name));
                    return Err(loader.value(&format!("{field}.object.name"), message));
                };
                for object in numbers {
                    let object = &mut objects[*object];
                    object.material = change.material.after(&object.material);
                    if let Some(mesh) = &change.mesh {
                        object.mesh = mesh.clone();
                    }
                    let field = format!("{field}, {}", change.name);
                    loader.material(&any, &object.material, false, &field)?;
                }
            }
            if i == shown {
                snapshot.objects = objects.clone();
            }
            if i == shown + 1 {
                snapshot.next = objects.clone();
            }
        }
        Ok(snapshot)
    }
}
