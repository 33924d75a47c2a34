//! A scene taken through its drags, as `cotillion run` does.

use std::sync::Arc;

use cotillion::discrete::drags::perform;
use cotillion::discrete::outcome::Outcome;
use cotillion::edit::EditError;
use cotillion::graph::scene::{graph_settings, scene_clips};
use cotillion::graph_cache::cached_graph;
use cotillion::scene::Scene;

/// The scene after its first solve, all drags and all discrete changes.
pub(crate) fn performed(scene: Scene) -> Result<Outcome, EditError> {
    let clips = if scene.discrete.is_some() { scene_clips(&scene) } else { Vec::new() };
    let (graph, _) = cached_graph(&clips, &graph_settings(scene.mode), None);
    perform(scene, Arc::new(graph), &clips, |_, _| {}).map(|editor| editor.into_outcome())
}
