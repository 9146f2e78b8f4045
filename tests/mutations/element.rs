//! Scene files as trees of elements, to be changed and written again.

use roxmltree::{Document, Node};

/// One element. Text between elements is not kept: scenes have none.
#[derive(Clone, Debug)]
pub struct Element {
    pub tag: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element>,
}

impl Element {
    pub fn parse(text: &str) -> Self {
        let document = Document::parse(text).unwrap_or_else(|e| panic!("{e}: {text}"));
        Self::of(document.root_element())
    }

    fn of(node: Node) -> Self {
        let attributes = node.attributes();
        Self {
            tag: node.tag_name().name().into(),
            attributes: attributes
                .map(|a| (a.name().into(), a.value().into()))
                .collect(),
            children: node
                .children()
                .filter(Node::is_element)
                .map(Self::of)
                .collect(),
        }
    }

    /// As a file, an element a line.
    pub fn text(&self) -> String {
        let mut out = String::new();
        self.write(&mut out, 0);
        out
    }

    fn write(&self, out: &mut String, depth: usize) {
        let indent = "  ".repeat(depth);
        out.push_str(&format!("{indent}<{}", self.tag));
        for (name, value) in &self.attributes {
            let value = value
                .replace('&', "&amp;")
                .replace('<', "&lt;")
                .replace('"', "&quot;");
            out.push_str(&format!(" {name}=\"{value}\""));
        }
        if self.children.is_empty() {
            return out.push_str("/>\n");
        }
        out.push_str(">\n");
        self.children.iter().for_each(|c| c.write(out, depth + 1));
        out.push_str(&format!("{indent}</{}>\n", self.tag));
    }

    /// How many elements there are, this one among them.
    pub fn count(&self) -> usize {
        1 + self.children.iter().map(Self::count).sum::<usize>()
    }

    /// Element `n` in the order of the file; this one is 0.
    pub fn nth(&mut self, n: usize) -> &mut Element {
        let mut left = n;
        self.find(&mut left).expect("an element of this number")
    }

    fn find(&mut self, left: &mut usize) -> Option<&mut Element> {
        if *left == 0 {
            return Some(self);
        }
        *left -= 1;
        self.children.iter_mut().find_map(|child| child.find(left))
    }

    pub fn attribute(&self, name: &str) -> Option<&str> {
        let found = self.attributes.iter().find(|(n, _)| n == name);
        found.map(|(_, value)| value.as_str())
    }

    /// For messages: `<float name="alpha">`.
    pub fn shown(&self) -> String {
        let name = ["name", "type", "id"].into_iter();
        let shown = name.filter_map(|n| Some(format!(" {n}=\"{}\"", self.attribute(n)?)));
        format!("<{}{}>", self.tag, shown.collect::<String>())
    }
}
