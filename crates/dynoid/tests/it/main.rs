//! The program as its users meet it: run on files, looked at from outside.

mod bad_input;
mod demo;
mod help;
mod init;
mod inspect;
mod study;
mod support;
mod terminal;
