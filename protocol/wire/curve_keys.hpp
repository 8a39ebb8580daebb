#pragma once
// The keys of a run across hosts. Who holds the coupler's public key can tell it from an impostor;
// the coupler lets in whose public keys lie in its folder, and nobody else. All that goes over the
// wire is encrypted (CurveZMQ). `undertow keys FOLDER` makes them.
//
//     coupler.key  sph.key  fem.key     "public TEXT", "secret TEXT", mode 0600: to their own host
//     only coupler.pub  sph.pub  fem.pub     "public TEXT": to everybody
//
// TEXT is Z85, 40 characters for 32 bytes.

#include <string>
#include <vector>

namespace undertow::wire {

struct CurveKeys {
    struct Friend {
        std::string name, key;  // of a participant, who may join
    };
    std::string own_public, own_secret;
    std::string coupler;          // a participant: whom it speaks to
    std::vector<Friend> friends;  // the coupler: who may come
};

/// The coupler: its key pair and all other public keys of the folder. InputError when something is
/// missing or wrong, or when others of the machine can read the secret.
CurveKeys keys_of_coupler(const std::string& folder);
/// A participant: the pair of that name, and the coupler's public key.
CurveKeys keys_of_participant(const std::string& folder, const std::string& name);

}  // namespace undertow::wire
