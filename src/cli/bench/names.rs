//! What can be measured: workloads, back ends, systems.

use clap::ValueEnum;
use cotillion_solvers::workload::{
    CHAIN_SAMPLES, PUBLISHED_SCENES, PublishedScene, Workload, published_scene, relay_chain,
};
use serde::{Deserialize, Serialize};

/// A problem of known size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum WorkloadName {
    /// Relay chain of 10 characters, 2 000 frames.
    #[value(name = "relay-chain-10")]
    #[serde(rename = "relay-chain-10")]
    RelayChain10,
    /// Relay chain of 78 characters, 15 600 frames.
    #[value(name = "relay-chain-78")]
    #[serde(rename = "relay-chain-78")]
    RelayChain78,
    /// Relay chain of 1 000 characters, 200 000 frames.
    #[value(name = "relay-chain-1000")]
    #[serde(rename = "relay-chain-1000")]
    RelayChain1000,
    /// Relay chain of 10 000 characters, 2 000 000 frames.
    #[value(name = "relay-chain-10000")]
    #[serde(rename = "relay-chain-10000")]
    RelayChain10000,
    /// Published scene: 4 characters, 605 frames.
    HighFive,
    /// Published scene: 3 characters, 885 frames.
    Chair,
    /// Published scene: 8 characters, 2 018 frames.
    Adventure,
    /// Published scene: 10 characters, 2 510 frames.
    Stacking,
    /// Published scene: 10 characters, 1 954 frames.
    Relay,
}

impl WorkloadName {
    /// Those of `--quick`.
    pub(super) const QUICK: [Self; 3] = [Self::RelayChain10, Self::RelayChain78, Self::HighFive];

    /// Characters of a relay chain.
    pub(super) fn chained(self) -> Option<usize> {
        match self {
            Self::RelayChain10 => Some(10),
            Self::RelayChain78 => Some(78),
            Self::RelayChain1000 => Some(1_000),
            Self::RelayChain10000 => Some(10_000),
            _ => None,
        }
    }

    /// The scene of the paper's table it stands for.
    pub(super) fn published(self) -> Option<&'static PublishedScene> {
        let place = match self {
            Self::HighFive => 0,
            Self::Chair => 1,
            Self::Adventure => 2,
            Self::Stacking => 3,
            Self::Relay => 4,
            _ => return None,
        };
        PUBLISHED_SCENES.get(place)
    }

    /// Characters and frames.
    pub(super) fn sizes(self) -> (usize, usize) {
        match (self.published(), self.chained()) {
            (Some(scene), _) => {
                (scene.characters.len(), scene.characters.iter().map(|counts| counts.samples).sum())
            }
            (None, characters) => {
                let characters = characters.expect("what is no scene is a chain");
                (characters, characters * CHAIN_SAMPLES)
            }
        }
    }

    /// Paths and rows. Cost: linear in the frames.
    pub(super) fn build(self) -> Workload {
        match self.published() {
            Some(scene) => published_scene(scene),
            None => relay_chain(self.chained().expect("what is no scene is a chain")),
        }
    }
}

/// A way to solve the systems of an edit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Backend {
    /// All frames as unknowns, two real numbers each; augmented matrix, sparse LU.
    DirectReal,
    /// All frames as unknowns, one complex number each; augmented matrix, sparse LU.
    DirectComplex,
    /// Constrained frames as unknowns; paths condensed by reflections, times to springs.
    Chain,
    /// Constraint rows as unknowns, and two for each path; paths as chains of springs, times as springs in series.
    Compliance,
}

impl Backend {
    /// The one that ratios are taken to.
    pub(super) const YARDSTICK: Self = Self::DirectComplex;

    /// Most frames it is asked to solve without `--all`: what takes seconds and less than a few gigabytes.
    pub(super) fn most_frames(self) -> usize {
        match self {
            Self::DirectReal | Self::DirectComplex => 500_000,
            Self::Chain | Self::Compliance => usize::MAX,
        }
    }
}

/// Which part of an edit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum System {
    /// Every frame keeps its place between its neighbours, up to a similarity.
    Shape,
    /// Segments get their lengths back, in the directions that shape gave.
    Scale,
    /// Steps of time keep their lengths.
    Time,
    /// The three in order.
    All,
}

/// From what on it is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Mode {
    /// From rest paths and rows to edited paths: everything.
    Cold,
    /// From new targets to edited paths, with all the rest reused.
    Drag,
}

/// The name of a value at the command line.
pub(super) fn name_of(value: impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn helps_give_the_true_counts() {
        for workload in WorkloadName::value_variants() {
            let (characters, frames) = workload.sizes();
            if frames < 1_000_000 {
                let built = workload.build();
                assert_eq!((built.paths.len(), built.samples()), (characters, frames));
            }
            let help =
                workload.to_possible_value().and_then(|value| value.get_help().map(ToString::to_string));
            let help = help.unwrap_or_default().replace(' ', "");
            assert!(help.contains(&format!("{characters}characters,{frames}frames")), "{help}");
        }
    }

    #[test]
    fn names_are_the_same_at_the_command_line_and_in_json() {
        for workload in WorkloadName::value_variants() {
            assert_eq!(serde_json::json!(workload), name_of(*workload));
        }
        for backend in Backend::value_variants() {
            assert_eq!(serde_json::json!(backend), name_of(*backend));
        }
    }
}
