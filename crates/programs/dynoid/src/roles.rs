//! The roles of channels in words.

use report::wording;
use rig::Role;
use serde::Serialize;

/// A role that a channel can play.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RoleFacts {
    /// Its key in a bench file, such as `dyno_speed`.
    pub key: &'static str,
    /// Its symbol, such as N_d.
    pub symbol: &'static str,
    /// Its name, such as "dynamometer speed".
    pub what: &'static str,
}

/// All roles, in the order in which people list them.
pub fn roles() -> Vec<RoleFacts> {
    let facts = |role: Role| RoleFacts { key: role.key(), symbol: role.symbol(), what: wording::role_name(role) };
    Role::ALL.into_iter().map(facts).collect()
}
