//! Motion graphs kept on disk, by what they are of.
//!
//! A graph is stored under the hash of everything that its search reads, so that one of clips that have changed is not found.
//! Files are written beside their final names and renamed. Deleting any of them is safe: it is made again.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::clip::working::WorkingClip;
use crate::export::files::write_one;
use crate::graph::stored::{GraphKey, StoredError, decode, encode};
use crate::graph::{GraphSettings, MotionGraph, material, search};

/// What a person might want to know about the cache; the graph is sound all the same.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CacheNote {
    /// What was stored is of no use and was replaced.
    #[error("{}: stored motion graph discarded: {why}", path.display())]
    Discarded {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: StoredError,
    },
    /// What was stored could not be read.
    #[error("{}: stored motion graph not read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The graph could not be stored.
    #[error("motion graph not stored: {0}")]
    NotStored(#[source] std::io::Error),
}

/// Motion graph of `clips`: the one stored in `folder`, else made and stored there (the folder is made if need be); without a
/// folder it is always made.
pub fn cached_graph(
    clips: &[Arc<WorkingClip>],
    settings: &GraphSettings,
    folder: Option<&Path>,
) -> (MotionGraph, Vec<CacheNote>) {
    let material = material(clips);
    let Some(folder) = folder else { return (search(&material, settings), Vec::new()) };
    let key = GraphKey::new(&material, settings);
    let path = folder.join(format!("{}.graph", key.hex()));
    let mut notes = Vec::new();
    match fs::read(&path) {
        Ok(bytes) => match decode(&bytes, &key) {
            Ok(graph) => return (graph, notes),
            Err(why) => notes.push(CacheNote::Discarded { path: path.clone(), why }),
        },
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(source) => notes.push(CacheNote::Unreadable { path: path.clone(), source }),
    }
    let graph = search(&material, settings);
    let stored = fs::create_dir_all(folder)
        .and_then(|()| write_one(&path, &encode(&graph, &key)).map_err(|error| error.source));
    notes.extend(stored.err().map(CacheNote::NotStored));
    (graph, notes)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::clip::builtin::generate;

    fn walk(seconds: f64) -> Vec<Arc<WorkingClip>> {
        let parameters = BTreeMap::from([("seconds".to_owned(), seconds)]);
        let clip = Arc::new(generate("walk", &parameters).expect("a generated clip"));
        let (first, last) = clip.usable;
        vec![Arc::new(WorkingClip::new("walk", clip, first, last))]
    }

    fn stored(folder: &Path) -> Vec<PathBuf> {
        fs::read_dir(folder).expect("readable").flatten().map(|entry| entry.path()).collect()
    }

    #[test]
    fn a_stored_graph_is_the_one_that_was_made() {
        let home = tempfile::tempdir().expect("a temporary folder");
        let folder = home.path().join("deep/cache");
        let settings = GraphSettings::default();
        let (made, notes) = cached_graph(&walk(4.0), &settings, Some(&folder));
        assert!(notes.is_empty() && !made.similar.is_empty());
        // A stored graph that differs from the made one shows which of them is returned.
        let path = &stored(&folder)[0];
        let key = GraphKey::new(&material(&walk(4.0)), &settings);
        let mut other = made.clone();
        other.distances.fill(0.25);
        fs::write(path, encode(&other, &key)).expect("a file");
        let (found, notes) = cached_graph(&walk(4.0), &settings, Some(&folder));
        assert!(notes.is_empty() && found == other);
        assert_eq!(cached_graph(&walk(4.0), &settings, None).0, made);
    }

    #[test]
    fn a_changed_clip_or_setting_has_a_graph_of_its_own() {
        let home = tempfile::tempdir().expect("a temporary folder");
        let strict = GraphSettings { largest_distance: Some(0.5), ..GraphSettings::default() };
        cached_graph(&walk(4.0), &GraphSettings::default(), Some(home.path()));
        cached_graph(&walk(4.0), &strict, Some(home.path()));
        let mut changed = walk(4.0);
        let clip = Arc::make_mut(&mut changed[0]);
        Arc::make_mut(&mut clip.clip).root_positions[50].y += 1e-6;
        cached_graph(&changed, &GraphSettings::default(), Some(home.path()));
        assert_eq!(stored(home.path()).len(), 3);
    }

    #[test]
    fn whatever_lies_in_the_cache_the_graph_is_right_and_a_note_says_so() {
        let home = tempfile::tempdir().expect("a temporary folder");
        let settings = GraphSettings::default();
        let (made, _) = cached_graph(&walk(4.0), &settings, Some(home.path()));
        let path = stored(home.path()).remove(0);
        let good = fs::read(&path).expect("stored");
        let mut spoiled: Vec<Vec<u8>> =
            (0..good.len()).step_by(97).map(|length| good[..length].to_vec()).collect();
        spoiled.extend((0..good.len()).step_by(41).map(|place| {
            let mut bytes = good.clone();
            bytes[place] ^= 0x20;
            bytes
        }));
        spoiled.push([good.clone(), vec![0]].concat());
        for bytes in spoiled {
            fs::write(&path, &bytes).expect("a file");
            let (graph, notes) = cached_graph(&walk(4.0), &settings, Some(home.path()));
            assert!(graph == made && matches!(notes[..], [CacheNote::Discarded { .. }]), "{notes:?}");
            assert_eq!(fs::read(&path).expect("stored anew"), good);
        }
        assert_eq!(stored(home.path()).len(), 1);
    }

    #[test]
    fn a_folder_that_cannot_be_written_costs_a_note() {
        let home = tempfile::tempdir().expect("a temporary folder");
        let file = home.path().join("file");
        fs::write(&file, "x").expect("a file");
        let (graph, notes) = cached_graph(&walk(4.0), &GraphSettings::default(), Some(&file));
        assert!(
            !graph.similar.is_empty() && matches!(notes.last(), Some(CacheNote::NotStored(_))),
            "{notes:?}"
        );
    }
}
