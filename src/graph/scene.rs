//! The motion graph of a scene: of every clip that somebody performs.

use std::sync::Arc;

use super::{GraphSettings, Maxima};
use crate::clip::working::WorkingClip;
use crate::scene::{Mode, Scene};
use crate::track::Track;

/// What a scene of this mode takes as similar.
pub fn graph_settings(mode: Mode) -> GraphSettings {
    let maxima = match mode {
        Mode::Paper => Maxima::Strict8,
        Mode::Production => Maxima::Ridge,
    };
    GraphSettings { maxima, ..GraphSettings::default() }
}

/// Clips that the characters of `scene` perform, each once for every body that performs it, in the order of the tracks.
pub fn scene_clips(scene: &Scene) -> Vec<Arc<WorkingClip>> {
    let mut clips: Vec<Arc<WorkingClip>> = Vec::new();
    for clip in scene.characters.iter().flat_map(|character| &character.track.clips) {
        if place(&clips, clip).is_none() {
            clips.push(clip.clone());
        }
    }
    clips
}

/// Position in `clips` of each entry of `track`; `None` for those that are not there.
pub fn entries(clips: &[Arc<WorkingClip>], track: &Track) -> Vec<Option<usize>> {
    track.clips.iter().map(|clip| place(clips, clip)).collect()
}

fn place(clips: &[Arc<WorkingClip>], clip: &Arc<WorkingClip>) -> Option<usize> {
    clips.iter().position(|known| Arc::ptr_eq(known, clip) || known == clip)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::graph::motion_graph;
    use crate::scene::{ClipFolders, load_text};

    const SCENE: &str = r#"
        [clips]
        come = "builtin:walk"
        rest = "builtin:idle"
        small = { builtin = "walk", stature = 1.5 }
        [[character]]
        name = "ann"
        track = ["come", "rest", "come"]
        [[character]]
        name = "bo"
        track = ["small", "come"]
        [[pin]]
        at = "ann:start"
        position = [0.0, 0.0]
    "#;

    #[test]
    fn a_clip_is_there_once_for_every_body() {
        let loaded = load_text(SCENE, Path::new("s.toml"), &ClipFolders::default()).expect("a sound scene");
        let clips = scene_clips(&loaded.scene);
        let tracks: Vec<Vec<Option<usize>>> =
            loaded.scene.characters.iter().map(|character| entries(&clips, &character.track)).collect();
        assert_eq!(tracks, [vec![Some(0), Some(1), Some(0)], vec![Some(2), Some(3)]]);
        let graph = motion_graph(&clips, &graph_settings(loaded.scene.mode));
        assert_eq!(graph.clips.iter().map(|clip| clip.body).collect::<Vec<_>>(), [0, 0, 1, 1]);
    }
}
