//! Names and sentences of the layout as other languages write them.

/// `specific_force` is `specificForce`, as in the names that UniFFI gives.
pub fn camel_case(name: &str) -> String {
    let mut words = name.split('_');
    let mut text = words.next().unwrap_or_default().to_owned();
    for word in words {
        let mut letters = word.chars();
        text.extend(letters.next().map(|first| first.to_ascii_uppercase()));
        text += letters.as_str();
    }
    text
}

/// A sentence as a list of parameters shows it: without its capital letter and stop.
pub fn in_a_list(sentence: &str) -> String {
    let text = sentence.trim_end_matches('.');
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().to_string() + letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_sentences_change_their_case() {
        assert_eq!(camel_case("uncalibrated_magnetic_field"), "uncalibratedMagneticField");
        assert_eq!(camel_case("x_m_s2"), "xMS2");
        assert_eq!(in_a_list("To the right, in m/s²."), "to the right, in m/s²");
    }
}
