"""Marsupial and the peers that are installed."""

from planner.peers import PEERS, PeerError, find_peer

OWN = "marsupial"


def installed_engines() -> tuple[str, ...]:
    """Names, marsupial first."""
    found = [OWN]
    for name, peer in PEERS.items():
        try:
            find_peer(name, peer)
        except PeerError:
            continue
        found.append(name)
    return tuple(found)
