//! What is no body: a grid on the ground, and boxes.

use glam::{DQuat, DVec3};
use gltf_json::animation::{Animation, Property};
use gltf_json::material::{Material, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::{Mesh, Mode, Primitive, Semantic};
use gltf_json::scene::{Node, UnitQuaternion};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index};

use super::buffer::{Document, Use};
use super::keys::{Changes, picked};
use super::{GlbObject, GlbScene, channel, narrow, quaternion, rows, steady, vector};
use crate::export::palette::linear;
use crate::geometry::{plan_of, yaw};
use crate::object::ObjectPose;

/// Widest grid, metres each way; scenes beyond it get the middle covered.
const WIDEST: f64 = 200.0;

/// A plain rough material.
pub(super) fn material(name: &str, colour: [u8; 3], roughness: f32) -> Material {
    let [r, g, b] = colour.map(|channel| narrow(linear(channel)));
    Material {
        name: Some(name.to_owned()),
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([r, g, b, 1.0]),
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(roughness),
            ..Default::default()
        },
        ..Default::default()
    }
}

/// Lines a metre apart under everything that happens.
pub(super) fn ground(document: &mut Document, scene: &GlbScene) -> Index<Node> {
    let everything: Vec<_> = scene
        .performers
        .iter()
        .flat_map(|performer| performer.clip.root_positions.iter().map(|root| plan_of(*root)))
        .chain(scene.objects.iter().flat_map(|object| object.poses.iter().map(ObjectPose::plan)))
        .collect();
    let [west, east] = extent(everything.iter().map(|p| p.re));
    let [south, north] = extent(everything.iter().map(|p| -p.im));
    let mut ends = Vec::new();
    for x in metres(west, east) {
        ends.extend([DVec3::new(x, 0.0, south), DVec3::new(x, 0.0, north)]);
    }
    for z in metres(south, north) {
        ends.extend([DVec3::new(west, 0.0, z), DVec3::new(east, 0.0, z)]);
    }
    let positions = document.floats(&rows(&ends), Use::Vertices, true);
    let attributes = vec![(Semantic::Positions, positions)];
    let grey = document.root.push(material("ground", [150, 150, 150], 1.0));
    let shape = Primitive {
        attributes: attributes.into_iter().map(|(name, data)| (Checked::Valid(name), data)).collect(),
        extensions: None,
        extras: Default::default(),
        indices: None,
        material: Some(grey),
        mode: Checked::Valid(Mode::Lines),
        targets: None,
    };
    let mesh = mesh_of(document, "ground", shape);
    document.root.push(Node { name: Some("ground".to_owned()), mesh: Some(mesh), ..Default::default() })
}

/// A box with flat sides.
pub(super) fn object(document: &mut Document, object: &GlbObject) -> Index<Node> {
    // In the box's axes: ahead is +x, left is −z.
    let half = DVec3::from_array(object.size) * 0.5;
    let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for axis in 0..3_u8 {
        for sign in [1.0, -1.0] {
            let (normal, u, v) = face(axis, sign);
            let corner = |a: f64, b: f64| (normal + u * a + v * b) * half + DVec3::Y * half.y;
            let first = crate::index::JointId::from_usize(positions.len()).0;
            positions.extend([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
            normals.extend([normal; 4]);
            indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
        }
    }
    let attributes: [(Semantic, Index<Accessor>); 2] = [
        (Semantic::Positions, document.floats(&rows(&positions), Use::Vertices, true)),
        (Semantic::Normals, document.floats(&rows(&normals), Use::Vertices, false)),
    ];
    let wood = document.root.push(material(object.name, [176, 148, 110], 0.9));
    let shape = Primitive {
        attributes: attributes.map(|(name, data)| (Checked::Valid(name), data)).into(),
        extensions: None,
        extras: Default::default(),
        indices: Some(document.indices(&indices)),
        material: Some(wood),
        mode: Checked::Valid(Mode::Triangles),
        targets: None,
    };
    let mesh = mesh_of(document, object.name, shape);
    document.root.push(Node {
        name: Some(object.name.to_owned()),
        mesh: Some(mesh),
        translation: Some(vector(object.poses[0].position)),
        rotation: Some(UnitQuaternion(quaternion(yaw(object.poses[0].facing)))),
        ..Default::default()
    })
}

/// Channels of a box that moves, with keyframes while it does.
pub(super) fn animate(
    document: &mut Document,
    animation: &mut Animation,
    object: &GlbObject,
    node: Index<Node>,
) {
    let places: Vec<DVec3> = object.poses.iter().map(|pose| pose.position).collect();
    let turns: Vec<DQuat> = object.poses.iter().map(|pose| yaw(pose.facing)).collect();
    let (places, turns) = (rows(&places), steady(turns.iter()));
    let mut changes = Changes::of(places.len());
    changes.note(&places);
    changes.note(&turns);
    let kept = changes.kept();
    let times = super::seconds(document, &kept, object.fps);
    let places = document.floats(&picked(&places, &kept), Use::Data, false);
    let turns = document.floats(&picked(&turns, &kept), Use::Data, false);
    channel(animation, (times, places), (node, Property::Translation));
    channel(animation, (times, turns), (node, Property::Rotation));
}

fn mesh_of(document: &mut Document, name: &str, shape: Primitive) -> Index<Mesh> {
    document.root.push(Mesh {
        extensions: None,
        extras: Default::default(),
        name: Some(name.to_owned()),
        primitives: vec![shape],
        weights: None,
    })
}

/// Outward normal of a side and two directions along it, `u × v = normal`.
fn face(axis: u8, sign: f64) -> (DVec3, DVec3, DVec3) {
    let (normal, u) = match axis {
        0 => (DVec3::X, DVec3::Y),
        1 => (DVec3::Y, DVec3::Z),
        _ => (DVec3::Z, DVec3::X),
    };
    let normal = normal * sign;
    (normal, u, normal.cross(u))
}

/// Whole metres around all `values`, with a metre to spare.
fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
    if low > high {
        return [-2.0, 2.0];
    }
    let middle = (0.5 * (low + high)).round();
    let reach = (0.5 * (high - low) + 1.5).ceil().min(WIDEST / 2.0);
    [middle - reach, middle + reach]
}

/// From `low` to `high` in steps of a metre.
fn metres(low: f64, high: f64) -> impl Iterator<Item = f64> {
    (0..=crate::index::floor_index(high - low)).map(move |k| low + k as f64)
}
