"""What a request about a robot's WiFi or broker says, and what the robot answers.

A part of the table in `messages.py`: its numbers are promises as well.
"""

from __future__ import annotations

# A network of WiFi comes in several frames: its name, its password, and what to do with both.
NETWORK_BYTES, PASSWORD_BYTES = 32, 63
LEAST_PASSWORD, WIFI_TEXT_BYTES = 8, 32  # of WPA2; of a name or of a part of a password
CLASS_BYTES, BROKER_PLACE_BYTES = 16, 6  # of a class: a to z, 0 to 9, -; of an address and a port
BROKER_NAME_BYTES, TRUST_BYTES = 96, 2048  # of the name of a computer; of a certificate in DER
WIFI_STEPS = (
    ("TELL", "Changes nothing."),
    ("NETWORK", "The name of a network. The robot forgets any earlier step."),
    ("PASSWORD", "The next part of its password."),
    ("JOIN", "The robot joins that network, now and after each reset."),
    ("HOST", "The robot is an access point with that name."),
    ("FORGET", "The robot uses no WiFi any more, and no broker."),
    (
        "BROKER",
        "An MQTT broker: its address, its port (16 bits) and the class. The robot forgets any earlier step. Empty: no broker.",
    ),
    ("BROKER_USER", "The robot's name there."),
    ("BROKER_PASSWORD", "The next part of its password there."),
    ("USE_BROKER", "The robot connects to that broker, now and after each reset, or to none."),
    (
        "TELL_BROKER",
        "Changes nothing. The reply is about the broker: `mode` 1 if there is one, its address, and in `network` the class.",
    ),
    (
        "BROKER_NAME",
        "The next part of the broker's name, as in its certificate. If the name is not found, the address counts.",
    ),
    (
        "BROKER_TLS",
        "Speak TLS with the broker. The text is today's date, as 20261121 (32 bits): a certificate that expired earlier is refused.",
    ),
    ("BROKER_TRUST", "The next part of the certificate that signs the broker's, in DER."),
)
WIFI_MODES = (
    ("OFF", "No network is set."),
    ("STATION", "The robot joins a network."),
    ("ACCESS_POINT", "The robot is one."),
)
WIFI_STATES = (
    ("OFF", "The robot has no WiFi, or has not begun with it."),
    ("SEARCHING", "It does not hear the network, or waits for an answer."),
    ("REFUSED", "The network has refused it: the password may be wrong."),
    ("READY", "It has an address."),
    ("UNTRUSTED", "The broker's certificate is not signed by the one that the robot trusts."),
    ("OTHER_NAME", "The broker's certificate is for a computer with another name."),
    ("EXPIRED", "The broker's certificate had expired before the robot got it."),
    ("NO_TLS", "The broker and the robot agree on no TLS, or the robot has no memory left for it."),
    (
        "RESTS",
        "Off: three times in a row the robot has restarted soon after WiFi began. JOIN, HOST and FORGET end that.",
    ),
)
