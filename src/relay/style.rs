//! What style sheets, `style` and attributes of an SVG say of an element: whether it is shown, and how it is transformed. Only here
//! is CSS read.

use std::str::FromStr;

use kurbo::Affine;
use roxmltree::{Document, Node};
use simplecss::{AttributeOperator, DeclarationTokenizer, Element, PseudoClass, StyleSheet};

/// The style sheets of a drawing.
pub struct Styles<'a>(StyleSheet<'a>);

/// A transform that is not understood: the property that asks for it, and its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// Its name.
    pub property: &'static str,
    /// Its value.
    pub value: String,
}

/// Other properties that move or turn an element than `transform`.
const MOVING: [&str; 5] = ["translate", "rotate", "scale", "offset-path", "zoom"];

/// What changes the meaning of `transform`.
const ABOUT: [&str; 2] = ["transform-origin", "transform-box"];

impl<'a> Styles<'a> {
    /// Those of all `style` elements, in their order.
    pub fn of(document: &'a Document<'_>) -> Self {
        let mut sheet = StyleSheet::new();
        let elements = document.descendants().filter(|node| is_element(node, "style"));
        elements.filter_map(|node| node.text()).for_each(|text| sheet.parse_more(text));
        Self(sheet)
    }

    /// Whether an element is drawn, as far as `display` and `visibility` say.
    pub fn is_shown(&self, node: &Node<'_, '_>) -> bool {
        let displayed =
            |node: Node<'_, '_>| self.property(&node, "display").is_none_or(|value| value != "none");
        let visibility = node
            .ancestors()
            .find_map(|node| self.property(&node, "visibility").filter(|value| value != "inherit"));
        let visible = visibility.is_none_or(|value| value != "hidden" && value != "collapse");
        visible && node.ancestors().all(displayed)
    }

    /// From an element's coordinates to those of the drawing.
    ///
    /// # Errors
    /// [`Unknown`] where something transforms it that is not understood.
    pub fn transform(&self, node: &Node<'_, '_>) -> Result<Affine, Unknown> {
        let mut whole = Affine::IDENTITY;
        for above in node.ancestors().filter(Node::is_element) {
            let own = self.property(&above, "transform").filter(|value| value != "none");
            let moving = MOVING.iter().map(|name| (*name, self.styled(&above, name)));
            let about = ABOUT.iter().map(|name| (*name, self.property(&above, name)));
            let about = about.filter(|_| own.is_some());
            let mut unknown = moving.chain(about).filter_map(|(name, value)| Some((name, value?)));
            if let Some((property, value)) = unknown.find(|(_, value)| !rests(value)) {
                return Err(Unknown { property, value });
            }
            whole = own.map_or(Ok(Affine::IDENTITY), |value| affine(&value))? * whole;
        }
        Ok(whole)
    }

    /// What holds for a property of an element: as CSS says, else the attribute of this name.
    fn property(&self, node: &Node<'_, '_>, name: &str) -> Option<String> {
        self.styled(node, name).or_else(|| node.attribute(name).map(|value| value.trim().to_owned()))
    }

    /// What CSS says: `style` before sheets, of these the most specific, of equals the last; `!important` before all.
    fn styled(&self, node: &Node<'_, '_>, name: &str) -> Option<String> {
        let rules = self.0.rules.iter().filter(|rule| rule.selector.matches(&Styled(*node)));
        let sheets = rules.flat_map(|rule| rule.declarations.iter().copied());
        let own = DeclarationTokenizer::from(node.attribute("style").unwrap_or_default());
        let all = sheets.chain(own).filter(|declaration| declaration.name == name);
        let strongest = all.fold(None, |known: Option<simplecss::Declaration<'_>>, next| match known {
            Some(known) if known.important && !next.important => Some(known),
            _ => Some(next),
        });
        strongest.map(|declaration| declaration.value.trim().to_owned())
    }
}

/// Values by which nothing is moved.
fn rests(value: &str) -> bool {
    matches!(value, "none" | "0" | "0px" | "0 0" | "0px 0px" | "view-box" | "initial" | "normal")
}

/// A list of transforms; lengths in pixels and angles in degrees may have their units.
fn affine(text: &str) -> Result<Affine, Unknown> {
    let plain = text.replace("px", "").replace("deg", "");
    let unknown = |_| Unknown { property: "transform", value: text.chars().take(60).collect() };
    let own = svgtypes::Transform::from_str(&plain).map_err(unknown)?;
    Ok(Affine::new([own.a, own.b, own.c, own.d, own.e, own.f]))
}

/// Whether it is an element of this name, whatever its name space.
fn is_element(node: &Node<'_, '_>, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

/// An element as selectors see it.
struct Styled<'a, 'i>(Node<'a, 'i>);

impl Element for Styled<'_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Self)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Self)
    }

    fn has_local_name(&self, name: &str) -> bool {
        is_element(&self.0, name)
    }

    fn attribute_matches(&self, local_name: &str, operator: AttributeOperator<'_>) -> bool {
        self.0.attribute(local_name).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        class == PseudoClass::FirstChild && self.0.prev_sibling_element().is_none()
    }
}
