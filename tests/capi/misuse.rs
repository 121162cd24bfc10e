//! Calls that are wrong give a status and a text.

use crate::library::{Linked, compile, outcome};
use crate::place::root;
use std::fs;
use std::process::Command;

#[test]
fn wrong_calls_are_refused() {
    let (code, text) = outcome(&mut Command::new(compile("misuse.c", Linked::Shared, &["-pthread"])));
    println!("{text}");
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("0 of them otherwise than expected"), "{text}");
}

/// No function is forgotten in the table.
#[test]
fn all_functions_are_called_wrongly() {
    let header = fs::read_to_string(root().join("src/capi/lightoven.h")).unwrap();
    let parts = fs::read_dir(root().join("tests/capi/misuse")).unwrap();
    let table: String = parts.map(|part| fs::read_to_string(part.unwrap().path()).unwrap()).collect();
    let functions = header.lines().filter_map(|line| line.strip_prefix("LightovenStatus ")?.split('(').next());
    let functions: Vec<&str> = functions.collect();
    assert!(functions.len() > 30, "{functions:?}");
    for function in functions {
        assert!(table.contains(&format!("REFUSED({function}(")), "{function} is not called wrongly");
    }
}
