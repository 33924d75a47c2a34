//! GLB files (binary glTF 2.0): every character a skinned simple body, one animation for all, objects as boxes.

pub(super) mod body_mesh;
mod buffer;
mod keys;
mod stage;

use std::sync::Arc;

use glam::{DQuat, DVec3};
use gltf_json::animation::{Animation, Channel, Interpolation, Property, Sampler, Target};
use gltf_json::mesh::{Mesh, Mode, Primitive, Semantic};
use gltf_json::scene::{Node, Scene, UnitQuaternion};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Asset, Index, Skin};

use self::body_mesh::body_mesh;
use self::buffer::{Document, Use};
use self::keys::{Changes, picked};
use crate::clip::Clip;
use crate::export::palette;
use crate::index::{JointId, SourceFrame};
use crate::object::ObjectPose;
use crate::skeleton::Skeleton;

/// What a GLB file shows.
#[derive(Clone, Debug, PartialEq)]
pub struct GlbScene<'a> {
    /// Name of the scene and of its animation.
    pub title: &'a str,
    /// All start together; each ends with its clip.
    pub performers: Vec<Performer<'a>>,
    /// Things that stand in the scene or move.
    pub objects: Vec<GlbObject<'a>>,
}

/// A character and its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Performer<'a> {
    /// For people.
    pub name: &'a str,
    /// Which of the scene's characters it is: its colour.
    pub number: usize,
    /// At least one frame.
    pub clip: &'a Clip,
}

/// A box that stands in the scene, or moves.
#[derive(Clone, Debug, PartialEq)]
pub struct GlbObject<'a> {
    /// For people.
    pub name: &'a str,
    /// Ahead, up, across, metres.
    pub size: [f64; 3],
    /// Where it is: one pose, or one a frame.
    pub poses: Vec<ObjectPose>,
    /// Frames per second.
    pub fps: f64,
}

/// The file's bytes; the same scene gives the same bytes.
///
/// # Panics
/// If a clip has no frames or an object no pose, or the file would exceed the 4 GiB its format allows.
pub fn to_glb(scene: &GlbScene) -> Vec<u8> {
    let mut document = Document::default();
    document.root.asset = Asset { generator: Some("cotillion".to_owned()), ..Default::default() };
    let mut animation = Animation {
        extensions: None,
        extras: Default::default(),
        channels: Vec::new(),
        name: Some(scene.title.to_owned()),
        samplers: Vec::new(),
    };
    let mut nodes = vec![stage::ground(&mut document, scene)];
    let mut cast = Cast::default();
    for performer in &scene.performers {
        nodes.extend(cast.enter(&mut document, &mut animation, performer));
    }
    for object in &scene.objects {
        let node = stage::object(&mut document, object);
        nodes.push(node);
        if object.poses.len() > 1 {
            stage::animate(&mut document, &mut animation, object, node);
        }
    }
    if !animation.channels.is_empty() {
        document.root.push(animation);
    }
    let stage = document.root.push(Scene {
        extensions: None,
        extras: Default::default(),
        name: Some(scene.title.to_owned()),
        nodes,
    });
    document.root.scene = Some(stage);
    document.into_glb()
}

/// Accessors that characters share.
#[derive(Default)]
struct Cast {
    bodies: Vec<(Arc<Skeleton>, Body)>,
}

/// Accessors of a body's mesh, in the order of the glTF names below, and of its bind pose.
#[derive(Clone, Copy)]
struct Body {
    positions: Index<Accessor>,
    normals: Index<Accessor>,
    joints: Index<Accessor>,
    weights: Index<Accessor>,
    indices: Index<Accessor>,
    inverse_bind: Index<Accessor>,
}

impl Cast {
    /// Adds one character; returns its nodes at the scene's root: skeleton, and mesh where it has any.
    fn enter(
        &mut self,
        document: &mut Document,
        animation: &mut Animation,
        performer: &Performer,
    ) -> Vec<Index<Node>> {
        let clip = performer.clip;
        let joints = joint_nodes(document, clip);
        let holder = document.root.push(Node {
            name: Some(performer.name.to_owned()),
            children: Some(vec![joints[0]]),
            ..Default::default()
        });
        animate(document, animation, clip, &joints);
        let Some(body) = self.body(document, &clip.skeleton) else {
            return vec![holder];
        };
        let skin = document.root.push(Skin {
            extensions: None,
            extras: Default::default(),
            inverse_bind_matrices: Some(body.inverse_bind),
            joints,
            name: Some(performer.name.to_owned()),
            skeleton: Some(holder),
        });
        let mesh = body_of(document, body, performer.name, palette::colour(performer.number));
        let body = document.root.push(Node {
            name: Some(format!("{} body", performer.name)),
            mesh: Some(mesh),
            skin: Some(skin),
            ..Default::default()
        });
        vec![holder, body]
    }

    /// Mesh of a skeleton, made once; none where no joint has a limb.
    fn body(&mut self, document: &mut Document, skeleton: &Arc<Skeleton>) -> Option<Body> {
        if let Some((_, body)) = self.bodies.iter().find(|(known, _)| known == skeleton) {
            return Some(*body);
        }
        let mesh = body_mesh(skeleton);
        if mesh.positions.is_empty() {
            return None;
        }
        let bind = skeleton.forward_kinematics(&skeleton.rest_pose());
        let inverse_bind: Vec<[f32; 16]> = bind.iter().map(|frame| translation(-frame.position)).collect();
        let joints: Vec<[u16; 4]> = mesh.joints.iter().map(|joint| [joint_number(*joint), 0, 0, 0]).collect();
        let indices: Vec<u32> =
            mesh.triangles.iter().flatten().map(|vertex| JointId::from_usize(*vertex).0).collect();
        let body = Body {
            positions: document.floats(&rows(&mesh.positions), Use::Vertices, true),
            normals: document.floats(&rows(&mesh.normals), Use::Vertices, false),
            joints: document.joints(&joints),
            weights: document.floats(&vec![[1.0, 0.0, 0.0, 0.0]; joints.len()], Use::Vertices, false),
            indices: document.indices(&indices),
            inverse_bind: document.floats(&inverse_bind, Use::Data, false),
        };
        self.bodies.push((skeleton.clone(), body));
        Some(body)
    }
}

/// Seconds of frames at a rate; the same frames share them.
fn seconds(document: &mut Document, kept: &[usize], fps: f64) -> Index<Accessor> {
    let seconds: Vec<[f32; 1]> = kept.iter().map(|frame| [narrow(*frame as f64 / fps)]).collect();
    document.floats(&seconds, Use::Data, true)
}

/// A node per joint, as in the first frame; children listed by their parents.
fn joint_nodes(document: &mut Document, clip: &Clip) -> Vec<Index<Node>> {
    let pose = clip.pose(SourceFrame(0));
    let first = JointId::from_usize(document.root.nodes.len()).0;
    let joints = &clip.skeleton.joints;
    let nodes: Vec<Index<Node>> = (first..).take(joints.len()).map(Index::new).collect();
    for (index, joint) in joints.iter().enumerate() {
        let place = match joint.parent {
            None => pose.root,
            Some(_) => pose.offset_of(JointId::from_usize(index)).unwrap_or(joint.offset),
        };
        let children: Vec<Index<Node>> = joints
            .iter()
            .zip(&nodes)
            .filter(|(child, _)| child.parent.is_some_and(|parent| parent.as_usize() == index))
            .map(|(_, node)| *node)
            .collect();
        document.root.push(Node {
            name: Some(joint.name.clone()),
            children: (!children.is_empty()).then_some(children),
            translation: Some(vector(place)),
            rotation: Some(UnitQuaternion(quaternion(pose.rotations[index]))),
            ..Default::default()
        });
    }
    nodes
}

/// Channels of one character: rotations of all joints, translations of the root and of joints that move. All have the same
/// keyframes: none within a stretch in which nothing moves.
fn animate(document: &mut Document, animation: &mut Animation, clip: &Clip, joints: &[Index<Node>]) {
    let mut changes = Changes::of(clip.frame_count());
    let mut places = vec![(0, rows(&clip.root_positions))];
    places.extend(clip.moving_offsets.iter().map(|moving| (moving.joint.as_usize(), rows(&moving.offsets))));
    places.iter().for_each(|(_, rows)| changes.note(rows));
    let rotations: Vec<Vec<[f32; 4]>> = (0..joints.len())
        .map(|joint| steady(clip.rotations.iter().skip(joint).step_by(joints.len())))
        .collect();
    rotations.iter().for_each(|rows| changes.note(rows));
    let kept = changes.kept();
    let times = seconds(document, &kept, clip.fps);
    for (joint, rows) in &places {
        let places = document.floats(&picked(rows, &kept), Use::Data, false);
        channel(animation, (times, places), (joints[*joint], Property::Translation));
    }
    for (joint, rows) in rotations.iter().enumerate() {
        let rotations = document.floats(&picked(rows, &kept), Use::Data, false);
        channel(animation, (times, rotations), (joints[joint], Property::Rotation));
    }
}

/// Adds a channel: times and values, node and property.
fn channel(
    animation: &mut Animation,
    (input, output): (Index<Accessor>, Index<Accessor>),
    (node, path): (Index<Node>, Property),
) {
    let sampler = Sampler {
        extensions: None,
        extras: Default::default(),
        input,
        interpolation: Checked::Valid(Interpolation::Linear),
        output,
    };
    let sampler = Index::push(&mut animation.samplers, sampler);
    animation.channels.push(Channel {
        sampler,
        target: Target { extensions: None, extras: Default::default(), node, path: Checked::Valid(path) },
        extensions: None,
        extras: Default::default(),
    });
}

/// Rotations with signs chosen so that neighbours are close: players interpolate without a detour.
fn steady<'q>(rotations: impl Iterator<Item = &'q DQuat>) -> Vec<[f32; 4]> {
    let mut before = DQuat::IDENTITY;
    rotations
        .map(|rotation| {
            before = if before.dot(*rotation) < 0.0 { -*rotation } else { *rotation };
            quaternion(before)
        })
        .collect()
}

fn body_of(document: &mut Document, body: Body, name: &str, colour: [u8; 3]) -> Index<Mesh> {
    let material = document.root.push(stage::material(name, colour, 0.75));
    let attributes = [
        (Semantic::Positions, body.positions),
        (Semantic::Normals, body.normals),
        (Semantic::Joints(0), body.joints),
        (Semantic::Weights(0), body.weights),
    ];
    document.root.push(Mesh {
        extensions: None,
        extras: Default::default(),
        name: Some(name.to_owned()),
        primitives: vec![Primitive {
            attributes: attributes.map(|(name, data)| (Checked::Valid(name), data)).into(),
            extensions: None,
            extras: Default::default(),
            indices: Some(body.indices),
            material: Some(material),
            mode: Checked::Valid(Mode::Triangles),
            targets: None,
        }],
        weights: None,
    })
}

/// Column-major matrix of a shift.
fn translation(shift: DVec3) -> [f32; 16] {
    let [x, y, z] = vector(shift);
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]
}

fn rows(points: &[DVec3]) -> Vec<[f32; 3]> {
    points.iter().map(|point| vector(*point)).collect()
}

fn vector(point: DVec3) -> [f32; 3] {
    point.to_array().map(narrow)
}

fn quaternion(rotation: DQuat) -> [f32; 4] {
    rotation.normalize().to_array().map(narrow)
}

fn joint_number(joint: usize) -> u16 {
    u16::try_from(joint).expect("fewer than 65536 joints")
}

/// Nearest single-precision number.
#[expect(clippy::cast_possible_truncation, reason = "glTF stores single precision")]
fn narrow(number: f64) -> f32 {
    number as f32
}

#[cfg(test)]
mod tests;
