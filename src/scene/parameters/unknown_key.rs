//! What to say of a key that the scene does not have: what is likely meant, or what there is.

use crate::scene::nearest::{self, first_names, nearest, shown};

/// The sentence. `known` are the keys that there are, of which only some may be told.
pub fn sentence(key: &str, known: &[&str]) -> String {
    let unknown = format!("there is no parameter \"{}\"", shown(key));
    let of = |owner: &str| {
        let beyond = |k: &&str| Some(k.strip_prefix(owner)?.strip_prefix('.')?.to_string());
        let names = first_names(known.iter().filter_map(beyond))?;
        Some(format!("{unknown}; {} has {names}", shown(owner)))
    };
    if let Some(sentence) = of(key) {
        return sentence;
    }
    if let Some(near) = nearest(key, known.iter().copied()).filter(|near| is_mistyped(key, near)) {
        return format!("{unknown}; the nearest is \"{near}\" (`warpath params` lists all)");
    }
    // "ball.bsdf.roughness" is answered by what `ball.bsdf` has, and else by what `ball` has.
    let mut owners = key.rmatch_indices('.').map(|(at, _)| &key[..at]);
    if let Some(sentence) = owners.find_map(of) {
        return sentence;
    }
    let (object, rest) = parts(key);
    // "translation" alone, or of an object that there is not.
    let ending = if rest.is_empty() { object } else { rest };
    let ends_so = |k: &&&str| parts(k).1 == ending;
    let others = known.iter().filter(ends_so).map(ToString::to_string);
    if let Some(names) = first_names(others) {
        return format!("{unknown}; there are {names}");
    }
    let objects = known.iter().map(|k| parts(k).0.to_string());
    match first_names(objects) {
        Some(names) => format!("{unknown}; it has to begin with one of {names}"),
        None => unknown,
    }
}

/// The object and what of it is meant.
fn parts(key: &str) -> (&str, &str) {
    key.split_once('.').unwrap_or((key, ""))
}

/// Whether both parts differ by few letters.
fn is_mistyped(key: &str, near: &str) -> bool {
    let (key, near) = (parts(key), parts(near));
    nearest::is_mistyped(key.0, near.0) && nearest::is_mistyped(key.1, near.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_what_is_meant_or_what_there_is() {
        let known = [
            "ball.bsdf.alpha",
            "ball.translation",
            "light.translation",
            "light.emitter.radiance.value",
        ];
        let said = |key: &str| {
            let sentence = sentence(key, &known);
            let head = format!("there is no parameter \"{key}\"; ");
            sentence.strip_prefix(&head).unwrap().to_string()
        };
        let near = "the nearest is \"ball.translation\" (`warpath params` lists all)";
        assert_eq!(said("bal.translatoin"), near);
        assert_eq!(said("ball.bsdf.roughness"), "ball.bsdf has alpha");
        assert_eq!(said("ball.bsdf"), "ball.bsdf has alpha");
        assert_eq!(
            said("light.intensity"),
            "light has translation, emitter.radiance.value"
        );
        let both = "there are ball.translation, light.translation";
        assert_eq!([said("lamp.translation"), said("translation")], [both; 2]);
        assert_eq!(
            said("lamp.radiance"),
            "it has to begin with one of ball, light"
        );
    }
}
