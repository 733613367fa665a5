"""Control of the feed override by the measured force."""
