//! The command line tool, run as a user runs it.

mod bad_input;
mod bake;
mod bench;
mod compare;
mod converge;
mod growth;
mod pipelines;
mod support;
mod usage;
mod variance;
mod verify;
