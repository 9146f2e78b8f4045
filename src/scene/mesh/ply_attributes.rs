//! Which properties of a PLY element make an attribute.

use super::Attribute;

/// One attribute of a PLY element: which of the element's other numbers it is made of.
pub(super) struct Columns {
    name: String,
    of_channel: Vec<usize>,
}

/// The attributes of an element of which `others` are the properties that mean nothing by
/// themselves, in their order: r, g and b, or red, green and blue, are `color`, and what has one
/// name but for a last part after `_` belongs together. As in Mitsuba one has one number or three.
pub(super) fn columns(prefix: &str, others: &[&str]) -> Vec<Columns> {
    let mut groups: Vec<Columns> = Vec::new();
    let colours = [["r", "g", "b"], ["red", "green", "blue"]].into_iter();
    let mut places = colours.map(|names| {
        let places = names.map(|name| others.iter().position(|other| *other == name));
        places.into_iter().collect::<Option<Vec<usize>>>()
    });
    if let Some(of_channel) = places.find_map(|places| places) {
        groups.push(Columns {
            name: format!("{prefix}_color"),
            of_channel,
        });
    }
    let mut of_names: Vec<Columns> = Vec::new();
    for (place, other) in others.iter().enumerate() {
        let Some((name, _)) = other.rsplit_once('_') else {
            continue;
        };
        let name = format!("{prefix}_{name}");
        match of_names.iter_mut().find(|group| group.name == name) {
            Some(group) => group.of_channel.push(place),
            None => of_names.push(Columns {
                name,
                of_channel: vec![place],
            }),
        }
    }
    for group in of_names {
        let is_new = groups.iter().all(|g| g.name != group.name);
        if is_new && matches!(group.of_channel.len(), 1 | 3) {
            groups.push(group);
        }
    }
    groups
}

impl Columns {
    /// The attribute, so far without values.
    pub fn attribute(&self) -> Attribute {
        Attribute {
            name: self.name.clone(),
            channels: self.of_channel.len(),
            values: Vec::new(),
        }
    }

    /// What one element has, whose other numbers are these.
    pub fn value(&self, others: &[f32]) -> [f32; 3] {
        let last = self.of_channel.len() - 1;
        [0, 1, 2].map(|channel| others[self.of_channel[channel.min(last)]])
    }
}
